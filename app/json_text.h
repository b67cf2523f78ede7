#pragma once

#include <string>

namespace planlight {

/// For people and programs, without its last line break. What is no UTF-8 (a file's name of another system) is written
/// as U+FFFD: it costs nobody the work that was done.
template <class Json>
std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

/// The same in one line.
template <class Json>
std::string json_line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace planlight
