#pragma once

#include <memory>

namespace planlight::test {

/// Whether anything on the whole screen is not black, as a person sees it: also where a window's monitor was, and while
/// monitors come and go.
class ScreenLight {
public:
    ScreenLight();
    ~ScreenLight();
    bool lit() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight::test
