#pragma once

#include <cstdint>
#include <vector>

#include "planning_io/types/image.h"

struct GLFWwindow;

namespace planlight {

/// Draws pictures 1:1, or black, into a window by OpenGL. It lives on one thread, whose context is the window's
/// meanwhile.
class PicturePainter {
public:
    /// Throws std::runtime_error when the graphics driver refuses.
    PicturePainter(GLFWwindow* window, int width, int height);
    ~PicturePainter();
    PicturePainter(const PicturePainter&) = delete;
    PicturePainter& operator=(const PicturePainter&) = delete;

    /// Returns when the picture (empty: black) has been handed to the display. Throws std::runtime_error when the
    /// driver reports an error, black first; and with `read_back` when what is in the window's buffer is not that
    /// picture: a driver that lost its context draws nothing and says nothing, while what it drew last is still lit.
    void draw(const RgbImage& picture, bool read_back);
    /// The last that can be done once something has failed; whether it is seen nobody can tell.
    void try_black() noexcept;

private:
    struct Place {
        int x = 0, y = 0;  ///< the first row is the top one
    };
    static std::vector<Place> lit_places(const RgbImage& picture);
    void put(const RgbImage& picture) const;
    bool reads_back(Place place, const Rgb& expected) const;
    bool draws_a_canary();
    bool is_in_buffer(const RgbImage& picture, const std::vector<Place>& lit_now) const;

    GLFWwindow* window_;
    int width_, height_;
    std::uint8_t canary_ = 0;
    std::vector<Place> lit_before_;  ///< of the picture that was drawn last
};

}  // namespace planlight
