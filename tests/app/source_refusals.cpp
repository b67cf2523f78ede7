#include "tests/app/source_refusals.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <regex>
#include <sstream>

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// The end of the string literal that begins at `at`.
std::size_t end_of_literal(const std::string& source, std::size_t at) {
    for (++at; at < source.size() && source[at] != '"'; ++at)
        if (source[at] == '\\') ++at;
    return at;
}

/// The arguments of the call whose bracket opens at `open`; `close` becomes the place of the bracket that ends it.
std::vector<std::string> arguments(const std::string& source, std::size_t open, std::size_t& close) {
    std::vector<std::string> found(1);
    int depth = 0;
    for (close = open + 1; close < source.size(); ++close) {
        const char c = source[close];
        if (c == '"') {
            const std::size_t end = end_of_literal(source, close);
            found.back() += source.substr(close, end - close + 1);
            close = end;
            continue;
        }
        if (c == '(' || c == '{' || c == '[') ++depth;
        if (c == ')' || c == '}' || c == ']') --depth;
        if (depth < 0) break;
        if (c == ',' && depth == 0)
            found.emplace_back();
        else
            found.back() += c;
    }
    return found;
}

/// A literal without its quotes and escapes, placeholders of fmt as "…".
std::string plain(const std::string& literal) {
    std::string text;
    for (std::size_t i = 0; i < literal.size(); ++i) {
        if (literal[i] == '\\' && i + 1 < literal.size())
            text += literal[++i] == 'n' ? ' ' : literal[i];
        else
            text += literal[i];
    }
    return std::regex_replace(text, std::regex("\\{[^}]*\\}"), "…");
}

/// Where a sign stands in an expression, within no bracket and no literal and, for ':', not in "::" and after as many
/// others as there are '?' in between; npos: nowhere.
std::size_t find_outside(const std::string& expression, char sign, std::size_t from) {
    int depth = 0, inner = 0;
    for (std::size_t i = from; i < expression.size(); ++i) {
        const char c = expression[i];
        if (c == '"') {
            i = end_of_literal(expression, i);
            continue;
        }
        if (c == '(' || c == '{' || c == '[') ++depth;
        if (c == ')' || c == '}' || c == ']') --depth;
        if (depth != 0) continue;
        if (expression.compare(i, 2, "::") == 0) {
            ++i;
            continue;
        }
        if (sign == ':' && c == '?') ++inner;
        if (c == sign && (sign != ':' || inner-- == 0)) return i;
    }
    return std::string::npos;
}

std::string words_in(const std::string& expression, const std::string& source);

/// Of `condition ? one : other`: both, parted by " / "; empty where the expression is none of these.
std::optional<std::string> words_of_both(const std::string& expression, const std::string& source) {
    const std::size_t question = find_outside(expression, '?', 0);
    if (question == std::string::npos) return std::nullopt;
    const std::size_t colon = find_outside(expression, ':', question + 1);
    if (colon == std::string::npos) return std::nullopt;
    const std::string one = words_in(expression.substr(question + 1, colon - question - 1), source),
                      other = words_in(expression.substr(colon + 1), source);
    return one.empty() || other.empty() || one == other ? (one.empty() ? other : one) : one + " / " + other;
}

/// The literals of an expression in their order, "…" for anything else between them.
std::string words_in(const std::string& expression, const std::string& source) {
    std::smatch name;
    static const std::regex kConstant("^\\s*(k[A-Z]\\w*)\\s*$");
    if (std::regex_match(expression, name, kConstant)) {
        const std::regex definition("\\b" + name[1].str() + "(\\[\\])?\\s*=\\s*(\"[^;]*\");");
        std::smatch found;
        return std::regex_search(source, found, definition) ? words_in(found[2].str(), source) : "…";
    }
    if (auto both = words_of_both(expression, source)) return *both;
    std::string text;
    bool between = false;  // something that is no literal stands since the last one
    const auto add = [&](const std::string& words) {
        text += (between ? "…" : "") + words;
        between = false;
    };
    for (std::size_t i = 0; i < expression.size(); ++i) {
        std::size_t close = 0;
        if (expression[i] == '"') {
            close = end_of_literal(expression, i);
            add(plain(expression.substr(i + 1, close - i - 1)));
            i = close;
        } else if (expression.compare(i, 12, "fmt::format(") == 0) {  // its first argument has the words
            add(words_in(arguments(expression, i + 11, close).front(), source));
            i = close;
        } else if (expression.compare(i, 12, "std::string(") == 0) {
            i += 10;
        } else if (expression[i] == '(') {
            const auto inside = arguments(expression, i, close);
            const auto both = inside.size() == 1 ? words_of_both(inside.front(), source) : std::nullopt;
            if (!both) continue;
            add(*both);
            i = close;
        } else if (std::isalnum(static_cast<unsigned char>(expression[i]))) {
            between = true;
        }
    }
    return between ? text + "…" : text;
}

std::string words(const std::string& expression, const std::string& source) {
    const std::string text = std::regex_replace(words_in(expression, source), std::regex("(…){2,}"), "…");
    return text.empty() ? "…" : text;
}

}  // namespace

std::vector<SourceRefusal> refusals_in_sources(const fs::path& root) {
    std::vector<fs::path> files;
    for (const char* room : {"planning_io", "segmentation", "registration", "projection", "app"})
        for (const auto& entry : fs::recursive_directory_iterator(root / room))
            if (entry.path().extension() == ".cpp" && entry.path().string().find("/simulation/") == std::string::npos)
                files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    static const std::regex kThrow(
        "\\b(InputError|DamagedFileError|DeviceError|CheckFailedError|DiskError|DiskRefusal|Error)\\(");
    std::vector<SourceRefusal> found;
    for (const fs::path& file : files) {
        const std::string source = text_of(file);
        for (std::sregex_iterator it(source.begin(), source.end(), kThrow), end; it != end; ++it) {
            const auto at = static_cast<std::size_t>(it->position());
            if (at >= 4 && source.substr(at - 4, 4).find("::") != std::string::npos) continue;  // another library's
            const std::string kind = (*it)[1] == "DiskRefusal" ? "DiskError" : (*it)[1].str();
            std::size_t close = 0;
            const auto given = arguments(source, at + static_cast<std::size_t>(it->length()) - 1, close);
            const std::size_t problem = kind == "CheckFailedError" ? 0 : 1;
            if (given.size() < problem + 2) continue;
            SourceRefusal refusal;
            refusal.file = fs::relative(file, root).string();
            refusal.line = static_cast<int>(std::count(source.begin(), source.begin() + it->position(), '\n')) + 1;
            refusal.kind = kind;
            refusal.problem = words(given[problem], source);
            if (kind == "DeviceError") refusal.problem = words(given[0], source) + ": " + refusal.problem;
            refusal.remedy = words(given[problem + 1], source);
            found.push_back(std::move(refusal));
        }
    }
    return found;
}

std::vector<std::string> options_named(const std::string& text) {
    static const std::regex kOption("(^|[^-\\w])(--[a-z][a-z-]*[a-z])");
    std::vector<std::string> options;
    for (std::sregex_iterator it(text.begin(), text.end(), kOption), end; it != end; ++it) options.push_back((*it)[2]);
    return options;
}

}  // namespace planlight::test
