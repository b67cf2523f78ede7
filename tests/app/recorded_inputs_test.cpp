#include "app/recording/recorded_inputs.h"

#include <gtest/gtest.h>

#include "planning_io/types/error.h"

namespace planlight {
namespace {

TEST(RecordedInputs, ComeBackAsTheyWere) {
    using Kind = RecordedInput::Kind;
    const std::vector<RecordedInput> inputs{{Kind::clock, Instant(-5), {}, 0, {}, {}},
                                            {Kind::shown, Instant(7), Instant(9), 0, "hash", {}},
                                            {Kind::dark, {}, {}, 0, {}, {}},
                                            {Kind::frame, Instant(1), Instant(2), 77, "other", {}},
                                            {Kind::failed, {}, {}, 0, "Left camera: is gone", "Plug it in."},
                                            {Kind::stopped, {}, {}, 0, "DARK", "Scan again."},
                                            {Kind::exposed, {}, {}, 0, {}, {}}};
    const std::string bytes = packed(inputs);
    const auto again = unpacked_inputs(bytes, "x");
    ASSERT_EQ(again.size(), inputs.size());
    EXPECT_EQ(packed(again), bytes);
    EXPECT_EQ(again[3].number, 77u);
    EXPECT_EQ(again[4].remedy, "Plug it in.");
    int refused = 0;
    for (std::size_t at = 0; at < bytes.size(); ++at) try {
            static_cast<void>(unpacked_inputs(std::string_view(bytes).substr(0, at), "x"));
        } catch (const DamagedFileError&) {
            ++refused;
        }
    EXPECT_EQ(refused, static_cast<int>(bytes.size() - inputs.size())) << "only between two entries is a cut an end";
}

}  // namespace
}  // namespace planlight
