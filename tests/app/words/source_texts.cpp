#include "tests/app/words/source_texts.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

namespace planlight::test {
namespace {

std::string unescaped(const std::string& literal) {
    std::string text;
    for (std::size_t i = 0; i < literal.size(); ++i) {
        if (literal[i] != '\\' || i + 1 == literal.size())
            text += literal[i];
        else if (literal.compare(i, 6, "\\u00b7") == 0)
            text += "·", i += 5;
        else if (literal[++i] == 'n')
            text += '\n';
        else
            text += literal[i];
    }
    return text;
}

}  // namespace

std::vector<std::string> literals_in(const std::filesystem::path& source) {
    std::ifstream in(source);
    std::ostringstream whole;
    for (std::string line; std::getline(in, line);)
        if (line.rfind("#include", 0) != 0) whole << line << '\n';
    const std::string code = whole.str();
    std::vector<std::string> found;
    bool beside = false;  // only blanks stand since the last literal
    for (std::size_t at = 0; at < code.size(); ++at) {
        if (code.compare(at, 2, "//") == 0) {
            at = std::min(code.find('\n', at), code.size());
        } else if (code.compare(at, 3, "R\"(") == 0) {
            at = std::min(code.find(")\"", at), code.size() - 1) + 1;
            beside = false;
        } else if (code[at] == '\'' && at + 2 < code.size()) {  // a character, or between the digits of a number
            const std::size_t end = code.find('\'', at + (code[at + 1] == '\\' ? 3 : 2));
            if (end != std::string::npos && end - at < 5) at = end;
            beside = false;
        } else if (code[at] == '"') {
            std::size_t end = at + 1;
            while (end < code.size() && code[end] != '"') end += code[end] == '\\' ? 2 : 1;
            const std::string text = unescaped(code.substr(at + 1, end - at - 1));
            if (beside)
                found.back() += text;
            else
                found.push_back(text);
            beside = true;
            at = end;
        } else if (std::isspace(static_cast<unsigned char>(code[at])) == 0) {
            beside = false;
        }
    }
    return found;
}

std::vector<std::string> as_said(const std::string& text) {
    static const std::regex kPlace("\\{[^{}]*\\}|…");
    std::vector<std::string> all{""};
    auto rest = text.cbegin();
    for (std::sregex_iterator it(text.begin(), text.end(), kPlace), end; it != end; ++it) {
        const std::string before(rest, (*it)[0].first);
        rest = (*it)[0].second;
        std::vector<std::string> more;
        for (const std::string& one : all) {
            more.push_back(one + before + "7");
            if (all.size() < 200) more.push_back(one + before);
        }
        all = std::move(more);
    }
    for (std::string& one : all) one.append(rest, text.cend());
    return all;
}

bool is_sentence(const std::string& text) {
    static const std::regex kWords("[A-Za-z]+[ ,].*[A-Za-z]{3,}|[A-Za-z]{3,}[ ,].*[A-Za-z]+");
    return std::regex_search(text, kWords);
}

}  // namespace planlight::test
