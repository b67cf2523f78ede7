#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace planlight {

/// A sentence with places: "only {n} of {n2} markers seen". A place whose name begins with "name" stands for any text,
/// which stays as it is; one that begins with "words" for text that is translated as well; every other one for a
/// number.
class WordPattern {
public:
    enum class Kind { literal, number, name, words };

    /// Throws std::invalid_argument for a bracket without its partner.
    explicit WordPattern(const std::string& text);

    using Values = std::map<std::string, std::string>;
    using Judge = std::function<bool(const std::string& words)>;

    /// What stands in the places; empty when the text is not of this kind. `accepts`: whether a text may stand in a
    /// place of words.
    std::optional<Values> match(const std::string& text, const Judge& accepts) const;

    /// The sentence with those values; a place without a value stays empty.
    std::string filled(const Values& values) const;

    std::vector<std::string> places() const;  ///< their names, sorted
    bool has_places() const { return pieces_.size() > 1 || (!pieces_.empty() && pieces_[0].kind != Kind::literal); }
    std::size_t own_letters() const;  ///< bytes outside of places

    static Kind kind_of(const std::string& place);

private:
    struct Piece {
        Kind kind;
        std::string text;  ///< of the literal, or the place's name
    };
    bool match_from(std::size_t piece, const std::string& text, std::size_t at, const Judge& accepts,
                    Values& values) const;

    std::vector<Piece> pieces_;
};

}  // namespace planlight
