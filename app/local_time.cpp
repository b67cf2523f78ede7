#include "app/local_time.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <optional>

namespace planlight {
namespace {

/// Empty where the text is none.
std::optional<std::time_t> moment_of(const std::string& utc) {
    std::tm parts{};
    const char* const end = strptime(utc.c_str(), "%Y-%m-%dT%H:%M:%S", &parts);
    if (end == nullptr || std::string(end) != "Z") return std::nullopt;
    return timegm(&parts);
}

/// The moment here; empty where the text is none.
std::optional<std::tm> here(const std::string& utc) {
    const auto moment = moment_of(utc);
    std::tm local{};
    return !moment || localtime_r(&*moment, &local) == nullptr ? std::nullopt : std::optional(local);
}

std::string zone_of(const std::tm& local) {
    const long minutes = std::abs(local.tm_gmtoff / 60);
    return fmt::format("(UTC{}{:02}:{:02})", local.tm_gmtoff < 0 ? '-' : '+', minutes / 60, minutes % 60);
}

}  // namespace

std::string local_time(const std::string& utc) {
    const auto local = here(utc);
    if (!local) return {};
    return fmt::format("{:%Y-%m-%d %H:%M:%S} {}", *local, local->tm_gmtoff == 0 ? "UTC" : zone_of(*local));
}

std::string short_local_time(const std::string& utc, const std::string& now_utc) {
    const auto local = here(utc), now = here(now_utc);
    if (!local) return {};
    const bool same_day = now && local->tm_year == now->tm_year && local->tm_yday == now->tm_yday;
    return fmt::format("{} {}", same_day ? fmt::format("{:%H:%M}", *local) : fmt::format("{:%Y-%m-%d %H:%M}", *local),
                       local->tm_gmtoff == 0 ? "UTC" : zone_of(*local));
}

std::string utc_and_local_time(const std::string& utc) {
    const auto local = here(utc);
    if (!local) return {};
    const std::string of_utc = fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(*moment_of(utc)));
    return local->tm_gmtoff == 0 ? of_utc : of_utc + "; here " + local_time(utc);
}

}  // namespace planlight
