#include "projector_picture.h"

namespace planlight::test {

RgbImage projector_picture(int width, int height) {
    RgbImage picture(width, height);
    std::uint32_t state = 2463534242U;  // xorshift (Marsaglia 2003)
    for (Rgb& pixel : picture.pixels) {
        state ^= state << 13U;
        state ^= state >> 17U;
        state ^= state << 5U;
        pixel = {static_cast<std::uint8_t>(state >> 24U), static_cast<std::uint8_t>(state >> 16U),
                 static_cast<std::uint8_t>((state >> 8U) | 1U)};
    }
    return picture;
}

}  // namespace planlight::test
