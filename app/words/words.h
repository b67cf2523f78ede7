#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "app/words/language_file.h"
#include "app/words/word_pattern.h"

namespace planlight {

/// What the windows say, in another language than English.
///
/// English is the source: sessions, recordings, `--json` and pages hold English, whatever the windows show. Only where
/// a window draws is a text translated: by its own entry, or by a pattern with places for figures and names, or part by
/// part. What has no translation is shown in English. Of one thread.
class Words {
public:
    /// English: everything as it is.
    Words() = default;
    explicit Words(const Language& language);

    std::string say(const std::string& english) const;

    /// All of the text has a translation; always so in English.
    bool knows(const std::string& english) const;

    const std::string& code() const { return code_; }  ///< "de"
    /// All letters that the translations may show, as one text.
    const std::string& letters() const { return letters_; }

private:
    struct Said {
        std::string text;
        bool whole = false;  ///< nothing of it is still English
    };
    struct Entry {
        WordPattern english, own;
    };
    Said said(const std::string& english, int depth) const;
    Said by_entry(const std::string& english, int depth) const;
    Said by_pattern(const std::string& english, bool strict, int depth) const;
    Said by_parts(const std::string& english, const std::string& between, int depth) const;

    std::string code_ = "en", letters_;
    std::unordered_map<std::string, std::string> plain_;
    std::vector<Entry> patterns_;  ///< those with most words of their own first
    mutable std::unordered_map<std::string, Said> before_;
};

/// The words of a language by its code ("de"): the site's own file where there is one, else what comes with the
/// program. Throws InputError for a language that nobody has translated, and for a file that is not as it should be.
std::shared_ptr<const Words> words_of(const std::string& code);

}  // namespace planlight
