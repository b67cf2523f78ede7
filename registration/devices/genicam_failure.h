#pragma once

#include <arv.h>

#include <string>

namespace planlight {

/// The error of a call into Aravis.
class GenicamFailure {
public:
    GenicamFailure() = default;
    GenicamFailure(const GenicamFailure&) = delete;
    GenicamFailure& operator=(const GenicamFailure&) = delete;
    ~GenicamFailure() { g_clear_error(&error_); }
    GError** slot() {
        g_clear_error(&error_);
        return &error_;
    }
    bool happened() const { return error_ != nullptr; }
    std::string text() const { return error_ ? error_->message : "unknown"; }

private:
    GError* error_ = nullptr;
};

}  // namespace planlight
