#pragma once

#include <vector>

namespace planlight::simulation {

/// Gaussian blur in place, sigma in pixels; outside the picture counts as zero. `scratch` is working memory.
void gaussian_blur(std::vector<float>& picture, std::vector<float>& scratch, int width, int height, double sigma_px);

/// Two running means of 2 radius + 1 pixels along both axes: a wide, cheap bell. Outside counts as zero.
void wide_blur(std::vector<float>& picture, std::vector<float>& scratch, int width, int height, int radius_px);

}  // namespace planlight::simulation
