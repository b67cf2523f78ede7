#pragma once

#include "registration/projector/measure_response.h"

namespace planlight {

/// Gamma and both ends through `result.curve`, with their standard deviations, and the worst departure.
void fit_response(ResponseResult& result);

/// The curve that was fitted, at a grey: 0 black, 1 white.
double fitted_light(const ResponseResult& result, double grey);

/// What a person should hear of the response, each with its remedy.
void add_findings(ResponseResult& result);

/// What the response means for the scan, one sentence.
std::string meaning_for_the_scan(const ResponseResult& result);

}  // namespace planlight
