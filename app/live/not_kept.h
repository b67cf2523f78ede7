#pragma once

#include <exception>
#include <string>

namespace planlight {

/// Why a match could not be kept, in a sentence each; empty where it was, or where none is kept.
struct NotKept {
    std::string in_the_banner;    ///< short: the window says it beside everything else
    std::string with_its_folder;  ///< for the page of evidence, the terminal and the log
};

/// The banner's sentence for what writing it threw.
std::string short_words_of_not_kept(const std::exception& fault);

}  // namespace planlight
