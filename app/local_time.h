#pragma once

#include <string>

namespace planlight {

/// A moment of UTC (ISO 8601, "2026-03-14T20:30:05Z") as this computer's clock on the wall has it, with how far that is
/// from UTC: "2026-03-15 02:00:05 (UTC+05:30)". Where the clock is that of UTC: "2026-03-14 20:30:05 UTC". Empty for
/// what is no such moment.
std::string local_time(const std::string& utc);

/// The same without its seconds, and without its day where that is today's here: "02:00 (UTC+05:30)". `now_utc`: the
/// moment at which it is said.
std::string short_local_time(const std::string& utc, const std::string& now_utc);

/// Both clocks, for who compares with another system: "2026-03-14 20:30:05 UTC; here 2026-03-15 02:00:05 (UTC+05:30)".
std::string utc_and_local_time(const std::string& utc);

}  // namespace planlight
