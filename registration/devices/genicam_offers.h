#pragma once

#include <arv.h>

#include <string>

// What a GenICam camera takes, as the remedy where it refused something else; where it does not say, its manual does.
namespace planlight {

std::string offered_formats(ArvCamera* camera);
std::string offered_lines(ArvCamera* camera);  ///< that may trigger it

using GenicamBounds = void (*)(ArvCamera*, double* least, double* most, GError**);
/// Of the value of `key` in room.json, whose unit is `by` of the camera's.
std::string offered_range(ArvCamera* camera, const char* key, GenicamBounds bounds_of, double by);

/// Bytes a second that its pictures travel with at the most: as it says itself, else of a usual link of its kind.
double link_speed(ArvCamera* camera);

}  // namespace planlight
