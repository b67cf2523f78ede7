#pragma once

#include "registration/projector_measurement/measure_response.h"

namespace planlight {

/// Gamma and both ends through `result.curve`, with their standard deviations, and the worst departure.
void fit_response(ResponseResult& result);

/// The curve that was fitted, at a grey: 0 black, 1 white.
double fitted_light(const ResponseResult& result, double grey);

}  // namespace planlight
