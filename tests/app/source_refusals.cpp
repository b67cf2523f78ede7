#include "tests/app/source_refusals.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
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

bool is_of_a_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
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
        if (c == '\'' && close + 2 < source.size() && source[close + 2] == '\'') {  // a bracket or quote as a character
            found.back() += source.substr(close, 3);
            close += 2;
            continue;
        }
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

/// A file of the product, and the project's headers that it includes.
struct Source {
    std::string text, headers;
};

Source read_source(const fs::path& file, const fs::path& root) {
    Source read{text_of(file), {}};
    static const std::regex kInclude("#include \"([^\"]+)\"");
    for (std::sregex_iterator it(read.text.begin(), read.text.end(), kInclude), end; it != end; ++it)
        read.headers += text_of(root / (*it)[1].str());
    return read;
}

/// Where an expression stands.
struct Place {
    const std::string& source;
    const std::string& headers;
    std::size_t function = 0, at = 0;          ///< where its function begins, and where it is
    std::map<std::string, std::string> given;  ///< parameters of that function, in words
    int depth = 0;                             ///< of names that stand for names
};

std::string words_in(const std::string& expression, const Place& place);

/// Of `condition ? one : other`: both, parted by " / "; empty where the expression is none of these.
std::optional<std::string> words_of_both(const std::string& expression, const Place& place) {
    const std::size_t question = find_outside(expression, '?', 0);
    if (question == std::string::npos) return std::nullopt;
    const std::size_t colon = find_outside(expression, ':', question + 1);
    if (colon == std::string::npos) return std::nullopt;
    const std::string one = words_in(expression.substr(question + 1, colon - question - 1), place),
                      other = words_in(expression.substr(colon + 1), place);
    return one.empty() || other.empty() || one == other ? (one.empty() ? other : one) : one + " / " + other;
}

/// Whether an expression is made of words alone, and not by a call that gives others.
bool is_of_words(const std::string& expression) {
    static const std::regex kCall("(\\w+)\\(");
    const std::string bare = std::regex_replace(expression, std::regex("\"([^\"\\\\]|\\\\.)*\""), "\"\"");
    for (std::sregex_iterator it(bare.begin(), bare.end(), kCall), end; it != end; ++it)
        if ((*it)[1] != "format" && (*it)[1] != "string") return false;
    return bare.find('"') != std::string::npos;
}

/// What a name is last set to between two places of a text; empty: to nothing that is words.
std::optional<std::string> last_set(const std::string& name, const std::string& text, std::size_t begin,
                                    std::size_t end) {
    std::optional<std::string> last;
    for (const std::string& sign : {name + " =", name + "[] ="})
        for (std::size_t at = text.find(sign, begin); at < end; at = text.find(sign, at + 1)) {
            if (at == 0 || is_of_a_name(text[at - 1])) continue;
            const std::size_t value = at + sign.size(), stop = find_outside(text, ';', value);
            if (stop >= end || text[value] == '=') continue;
            if (const std::string words = text.substr(value, stop - value); is_of_words(words)) last = words;
        }
    return last;
}

/// What a name was set to: a constant of the file or of a header, or a text of the same function before the place;
/// empty: none of these.
std::optional<std::string> value_of(const std::string& name, const Place& place) {
    const bool constant = name.size() > 1 && name[0] == 'k' && std::isupper(static_cast<unsigned char>(name[1])) != 0;
    if (!constant) return last_set(name, place.source, place.function, place.at);
    const auto of_the_file = last_set(name, place.source, 0, place.source.size());
    return of_the_file ? of_the_file : last_set(name, place.headers, 0, place.headers.size());
}

/// Of a name of the expression: its words; empty: nothing is known of it.
std::optional<std::string> words_of_name(const std::string& name, const Place& place) {
    constexpr int kDeepest = 3;
    if (const auto given = place.given.find(name); given != place.given.end())
        return given->second == "…" ? std::nullopt : std::optional(given->second);
    if (place.depth >= kDeepest) return std::nullopt;
    const auto value = value_of(name, place);
    if (!value) return std::nullopt;
    Place deeper = place;
    ++deeper.depth;
    return words_in(*value, deeper);
}

/// The literals of an expression in their order, also those that a name stands for; "…" for anything else between them.
std::string words_in(const std::string& expression, const Place& place) {
    if (auto both = words_of_both(expression, place)) return *both;
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
            add(words_in(arguments(expression, i + 11, close).front(), place));
            i = close;
        } else if (expression.compare(i, 12, "std::string(") == 0) {
            i += 10;
        } else if (expression[i] == '(') {
            const auto inside = arguments(expression, i, close);
            const auto both = inside.size() == 1 ? words_of_both(inside.front(), place) : std::nullopt;
            if (!both) continue;
            add(*both);
            i = close;
        } else if (is_of_a_name(expression[i])) {
            const std::size_t begin = i;
            while (i + 1 < expression.size() && is_of_a_name(expression[i + 1])) ++i;
            const auto is_one_of = [&](std::size_t at, const char* signs) {
                return at < expression.size() && std::string(signs).find(expression[at]) != std::string::npos;
            };
            const bool by_itself = (begin == 0 || !is_one_of(begin - 1, ".>:")) && !is_one_of(i + 1, ".-:([{");
            const auto words = by_itself ? words_of_name(expression.substr(begin, i + 1 - begin), place) : std::nullopt;
            if (words)
                add(*words);
            else
                between = true;
        }
    }
    return between ? text + "…" : text;
}

std::string words(const std::string& expression, const Place& place) {
    const std::string text = std::regex_replace(words_in(expression, place), std::regex("(…){2,}"), "…");
    return text.empty() ? "…" : text;
}

/// A function, or a lambda with a name, that may pass on what it is given.
struct Teller {
    std::string name;
    std::vector<std::string> parameters, defaults;  ///< as many; a default may be empty
    bool lambda = false, member = false;
};

Teller teller(const std::string& name, const std::vector<std::string>& list) {
    static const std::regex kParameter("(\\w+)\\s*(=\\s*([\\s\\S]*))?$");
    Teller made{name, {}, {}, false, false};
    for (const std::string& one : list) {
        std::smatch found;
        if (!std::regex_search(one, found, kParameter)) continue;
        made.parameters.push_back(found[1]);
        made.defaults.push_back(found[3]);
    }
    return made;
}

/// Where the function begins that `at` is in: the last line before it that begins at the margin with a word.
std::size_t function_of(const std::string& source, std::size_t at) {
    for (std::size_t line = source.rfind('\n', at); line != std::string::npos && line > 0;
         line = source.rfind('\n', line - 1))
        if (is_of_a_name(source[line + 1]) || source[line + 1] == '[') return line + 1;
    return 0;
}

/// The named lambdas, from the inside out, and the function that a place stands in.
std::vector<Teller> tellers_of(const std::string& source, std::size_t at) {
    std::vector<Teller> tellers;
    const std::size_t from = function_of(source, at);
    const std::string head = source.substr(from, at - from);
    static const std::regex kLambda("auto (\\w+) = \\[[^\\]]*\\]\\(");
    for (std::sregex_iterator it(head.begin(), head.end(), kLambda), end; it != end; ++it) {
        std::size_t close = 0, last = 0;
        const auto open = from + static_cast<std::size_t>(it->position() + it->length()) - 1;
        const auto list = arguments(source, open, close);
        const std::size_t body = source.find('{', close);
        if (body == std::string::npos || body > at) continue;
        arguments(source, body, last);
        if (last < at) continue;  // it ended before
        tellers.insert(tellers.begin(), teller((*it)[1], list));
        tellers.front().lambda = true;
    }
    static const std::regex kFunction("^[^({;=]*?(::)?(\\w+)\\(");
    std::smatch found;
    if (std::regex_search(head, found, kFunction)) {
        std::size_t close = 0;
        tellers.push_back(
            teller(found[2],
                   arguments(source, from + static_cast<std::size_t>(found.position() + found.length()) - 1, close)));
        tellers.back().member = found[1].matched;
    }
    return tellers;
}

bool names_any(const std::string& expression, const std::vector<std::string>& names) {
    const std::string bare = std::regex_replace(expression, std::regex("\"([^\"\\\\]|\\\\.)*\""), "\"\"");
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return std::regex_search(bare, std::regex("(^|[^\\w.>:])" + name + "($|[^\\w(.\\-:])"));
    });
}

/// Expressions of one place in words, and where they come from.
struct Said {
    std::size_t at;
    std::vector<std::string> words;
};

struct Call {
    std::size_t at;
    std::vector<std::string> arguments;
};

/// All calls in the same file; of a lambda those in its function.
std::vector<Call> calls_of(const Teller& teller, const std::string& source, std::size_t at) {
    std::vector<Call> calls;
    const std::string name = teller.name + "(";
    for (std::size_t found = source.find(name); found != std::string::npos; found = source.find(name, found + 1)) {
        if (found == 0 || is_of_a_name(source[found - 1]) || source[found - 1] == ':') continue;
        if (teller.lambda && function_of(source, found) != function_of(source, at)) continue;
        if (source[source.rfind('\n', found) + 1] != ' ') continue;  // at the margin: where it is declared
        std::size_t close = 0;
        calls.push_back({found, arguments(source, found + name.size() - 1, close)});
    }
    return calls;
}

/// The expressions in words; where one of them is nothing but what the function was given, once for each call of it.
std::vector<Said> said_at(const Source& file, std::size_t at, const std::vector<std::string>& expressions, int depth) {
    constexpr int kDeepest = 2;
    const std::string& source = file.text;
    Place place{source, file.headers, function_of(source, at), at, {}, 0};
    const auto in_words = [&](std::size_t where) {
        Said said{where, {}};
        for (const std::string& expression : expressions) said.words.push_back(words(expression, place));
        return said;
    };
    const Said here = in_words(at);
    std::vector<std::string> untold;
    for (std::size_t i = 0; i < expressions.size(); ++i)
        if (here.words[i] == "…") untold.push_back(expressions[i]);
    if (untold.empty() || depth == kDeepest) return {here};
    std::vector<Said> all;
    for (const Teller& teller : tellers_of(source, at)) {
        const bool told = std::any_of(untold.begin(), untold.end(),
                                      [&](const std::string& e) { return names_any(e, teller.parameters); });
        if (!told) continue;
        for (Call& call : calls_of(teller, source, at)) {
            for (std::size_t i = call.arguments.size(); i < teller.parameters.size(); ++i)
                call.arguments.push_back(teller.defaults[i]);
            if (call.arguments.size() != teller.parameters.size()) continue;
            for (const Said& one : said_at(file, call.at, call.arguments, depth + 1)) {
                for (std::size_t i = 0; i < one.words.size(); ++i) place.given[teller.parameters[i]] = one.words[i];
                all.push_back(in_words(one.at));
            }
        }
        break;
    }
    return all.empty() ? std::vector{here} : all;
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
        "\\b(InputError|DamagedFileError|DeviceError|UnendedProjector|CheckFailedError|DiskError|DiskRefusal|Error)"
        "\\(");
    std::vector<SourceRefusal> found;
    for (const fs::path& file : files) {
        const Source read = read_source(file, root);
        const std::string& source = read.text;
        for (std::sregex_iterator it(source.begin(), source.end(), kThrow), end; it != end; ++it) {
            const auto at = static_cast<std::size_t>(it->position());
            if (at >= 4 && source.substr(at - 4, 4).find("::") != std::string::npos) continue;  // another library's
            const std::string kind = (*it)[1] == "DiskRefusal"        ? "DiskError"
                                     : (*it)[1] == "UnendedProjector" ? "DeviceError"
                                                                      : (*it)[1].str();
            std::size_t close = 0;
            const auto given = arguments(source, at + static_cast<std::size_t>(it->length()) - 1, close);
            const std::size_t problem = kind == "CheckFailedError" ? 0 : 1;
            if (given.size() < problem + 2) continue;
            std::vector<std::string> expressions{given[problem], given[problem + 1]};
            if (kind == "DeviceError") expressions.push_back(given[0]);
            for (const Said& said : said_at(read, at, expressions, 0)) {
                SourceRefusal refusal;
                refusal.file = fs::relative(file, root).string();
                refusal.line = static_cast<int>(std::count(
                                   source.begin(), source.begin() + static_cast<std::ptrdiff_t>(said.at), '\n')) +
                               1;
                refusal.kind = kind;
                refusal.problem = said.words[0];
                if (kind == "DeviceError") refusal.problem = said.words[2] + ": " + refusal.problem;
                refusal.remedy = said.words[1];
                found.push_back(std::move(refusal));
            }
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
