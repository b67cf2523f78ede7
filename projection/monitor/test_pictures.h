#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/image.h"
#include "projection/monitor/projector_window.h"

namespace planlight {

/// What a projector shows while projector and cameras are aimed, focused and exposed.
enum class TestPicture {
    dark,
    frame,  ///< a border of one pixel along its edges and a cross in its middle: where its light falls
    star,   ///< Siemens stars in the middle and in the corners: sharp as far inwards as the focus is good
    steps,  ///< bars of even grey steps from black to white: exposure, and whether the picture mode keeps its greys
    name,   ///< which monitor this is
};

inline constexpr TestPicture kTestPictures[] = {TestPicture::dark, TestPicture::frame, TestPicture::star,
                                                TestPicture::steps, TestPicture::name};

/// "frame", as commands and their JSON call it.
const char* text_of(TestPicture picture);
std::optional<TestPicture> test_picture_of(const std::string& text);

/// A Siemens star: white and black sectors of equal width about a middle.
struct SiemensStar {
    double x = 0, y = 0, radius = 0;  ///< pixels
    int spokes = 36;                  ///< white ones
};

/// The stars of that picture, the middle one first.
std::vector<SiemensStar> siemens_stars(int width, int height);

inline constexpr int kGreySteps = 16;

/// In the pixels of that monitor, each for itself: nothing is scaled. `number`: of the monitor, as it is listed.
RgbImage draw_test_picture(TestPicture picture, const Monitor& monitor, int number = 0);

}  // namespace planlight
