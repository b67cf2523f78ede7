#include "app/local_time.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>

namespace planlight {
namespace {

/// The computer stands in that zone (POSIX: hours west of UTC) for as long as this lives.
class Zone {
public:
    explicit Zone(const char* zone) : was_(std::getenv("TZ") ? std::getenv("TZ") : "") {
        ::setenv("TZ", zone, 1);
        ::tzset();
    }
    ~Zone() {
        was_.empty() ? ::unsetenv("TZ") : ::setenv("TZ", was_.c_str(), 1);
        ::tzset();
    }
    Zone(const Zone&) = delete;
    Zone& operator=(const Zone&) = delete;

private:
    std::string was_;
};

TEST(LocalTime, IsThatOfTheClockOnTheWallWithItsDayAndHowFarItIsFromUtc) {
    const std::string moment = "2026-03-14T20:30:05Z";
    {
        const Zone india("UTC-5:30");
        EXPECT_EQ(local_time(moment), "2026-03-15 02:00:05 (UTC+05:30)");
        EXPECT_EQ(short_local_time(moment, "2026-03-15T18:29:59Z"), "02:00 (UTC+05:30)");
        EXPECT_EQ(short_local_time(moment, "2026-03-15T18:30:00Z"), "2026-03-15 02:00 (UTC+05:30)")
            << "said after midnight there: of the day before";
        EXPECT_EQ(utc_and_local_time(moment), "2026-03-14 20:30:05 UTC; here 2026-03-15 02:00:05 (UTC+05:30)");
    }
    const Zone greenwich("UTC0");
    EXPECT_EQ(short_local_time(moment, "2026-03-14T20:40:00Z"), "20:30 UTC");
    EXPECT_EQ(short_local_time(moment, "2025-03-14T20:40:00Z"), "2026-03-14 20:30 UTC")
        << "the same day of another year";
    EXPECT_EQ(utc_and_local_time(moment), "2026-03-14 20:30:05 UTC") << "not twice the same";
}

TEST(LocalTime, OfWhatIsNoMomentOfUtcThereIsNone) {
    for (const char* text : {"", "yesterday", "2026-03-14", "2026-03-14T20:30:05", "2026-03-14T20:30:05Z "})
        EXPECT_EQ(local_time(text) + short_local_time(text, text) + utc_and_local_time(text), "") << text;
}

}  // namespace
}  // namespace planlight
