#pragma once

namespace planlight::test {

/// What the desktop shows where no window is: one colour, 0xRRGGBB, told as compositors look for it. It goes with this
/// object.
class DesktopPicture {
public:
    explicit DesktopPicture(unsigned long colour);
    ~DesktopPicture();
    DesktopPicture(const DesktopPicture&) = delete;
    DesktopPicture& operator=(const DesktopPicture&) = delete;

private:
    void* display_;
};

}  // namespace planlight::test
