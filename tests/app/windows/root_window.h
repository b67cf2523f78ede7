#pragma once

#include <string>

#include "planning_io/types/image.h"
#include "projection/monitor/projector_window.h"

namespace planlight::test {

/// One line "ok" or "FAIL" on standard output; failures are counted.
void expect(bool fact, const std::string& what);
int failures();

/// The root window as a person would see it, by ImageMagick's import; the picture stays in `folder`.
RgbImage screen(const std::string& folder, const std::string& name);

/// How many pixels of the monitor differ from `wanted`.
long different(const RgbImage& root, const Monitor& monitor, const RgbImage& wanted);

}  // namespace planlight::test
