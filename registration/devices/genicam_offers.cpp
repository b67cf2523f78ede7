#include "registration/devices/genicam_offers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "registration/devices/genicam_failure.h"

namespace planlight {
namespace {

using ListOf = const char** (*)(ArvCamera*, guint*, GError**);

/// What a camera offers; empty where it does not say.
std::vector<std::string> offered(ArvCamera* camera, ListOf list_of) {
    guint count = 0;
    const char** const words = list_of(camera, &count, GenicamFailure().slot());
    std::vector<std::string> list;
    for (guint i = 0; words != nullptr && i < count; ++i) list.emplace_back(words[i]);
    g_free(words);
    return list;
}

}  // namespace

std::string offered_formats(ArvCamera* camera) {
    const auto formats = offered(camera, arv_camera_dup_available_pixel_formats_as_strings);
    if (formats.empty()) return "Give \"pixel_format\" as its manual has it.";
    const bool grey = std::ranges::any_of(formats, [](const std::string& f) { return f.starts_with("Mono"); });
    const std::string all = fmt::format("{}", fmt::join(formats, ", "));
    return grey
               ? fmt::format("Set \"pixel_format\" to a grey one of these: {}.", all)
               : fmt::format(
                     "It is a colour camera ({}): take a grey one, or let a \"pipeline\" turn its pictures grey.", all);
}

std::string offered_range(ArvCamera* camera, const char* key, GenicamBounds bounds_of, double by) {
    double least = 0, most = 0;
    GenicamFailure failure;
    bounds_of(camera, &least, &most, failure.slot());
    if (failure.happened() || !(most > least)) return fmt::format("Give \"{}\" as its manual has it.", key);
    return fmt::format(
        "Set \"{}\" to {:.3g} to {:.3g}; where that is too little, see whether the frame rate and the "
        "region leave room for it.",
        key, by * least, by * most);
}

std::string offered_lines(ArvCamera* camera) {
    const auto lines = offered(camera, arv_camera_dup_available_trigger_sources);
    return lines.empty() ? std::string("Give \"line\" as its manual has it.")
                         : fmt::format("Set \"line\" to one of these: {}.", fmt::join(lines, ", "));
}

double link_speed(ArvCamera* camera) {
    constexpr double kGigabit = 125e6, kUsb3 = 400e6;
    GenicamFailure failure;
    if (arv_camera_is_feature_available(camera, "DeviceLinkSpeed", failure.slot())) {
        const double said = static_cast<double>(arv_camera_get_integer(camera, "DeviceLinkSpeed", failure.slot()));
        if (!failure.happened() && said > 1e6) return said;
    }
    return arv_camera_is_uv_device(camera) ? kUsb3 : kGigabit;
}

}  // namespace planlight
