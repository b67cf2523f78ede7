#include "app/doctor/light_until_ended.h"

#include <gtest/gtest.h>

#include <optional>

namespace planlight {
namespace {

struct NotedProjector final : Projector {
    bool lit = false;
    int width() const override { return 8; }
    int height() const override { return 6; }
    Instant show(const RgbImage&, Instant) override {
        lit = true;
        return {};
    }
    void go_dark() noexcept override { lit = false; }
};

TEST(LightUntilEnded, IsDarkAsSoonAsItIsEndedAndIsNotLitAgain) {
    NotedProjector projector;
    std::stop_source ended;
    LightUntilEnded light(projector, ended.get_token());
    light.show(RgbImage(8, 6), std::chrono::seconds(1));
    EXPECT_TRUE(projector.lit);
    ended.request_stop();
    EXPECT_FALSE(projector.lit) << "at once, not with the next picture";
    EXPECT_THROW(light.show(RgbImage(8, 6), std::chrono::seconds(1)), ExaminationEnded);
    EXPECT_FALSE(projector.lit);
}

TEST(LightUntilEnded, TouchesNoProjectorThatIsGone) {
    std::stop_source ended;
    {
        NotedProjector projector;
        const LightUntilEnded light(projector, ended.get_token());
    }
    EXPECT_TRUE(ended.request_stop());
}

}  // namespace
}  // namespace planlight
