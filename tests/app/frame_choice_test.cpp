#include "app/recording/frame_choice.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

TEST(FrameChoice, KeepsWithinItsBudgetWhateverHappens) {
    for (const double bytes : {250e3, 1.4e6})                // of a frame in the paper's room, in a modern one
        for (const double beside : {0.0, 1.8e3, 4e3, 10e3})  // of all else, a frame; 1.8 kB in the paper's room
            for (const int event_every : {0, 25, 1}) {       // frames
                FrameChoice choice;
                double kept = 0;
                for (int i = 0; i < 3600 * 25; ++i) {
                    if (choice.keep(i * std::chrono::milliseconds(40), bytes)) kept += bytes;
                    if (event_every > 0 && i % event_every == 0)
                        kept += bytes * static_cast<double>(choice.event(12, bytes));
                    choice.written(beside);
                    kept += beside;
                }
                EXPECT_LE(kept, 1e9) << bytes << " bytes a frame, an event every " << event_every << ", beside it "
                                     << beside;
                EXPECT_GE(kept, 0.3e9) << bytes << " bytes a frame, an event every " << event_every << ", beside it "
                                       << beside;
            }
}

TEST(FrameChoice, KeepsTheFramesRoundAnEvent) {
    FrameChoice choice;
    int kept = 0;
    for (int i = 0; i < 25; ++i) kept += choice.keep(i * std::chrono::milliseconds(40), 250e3);
    EXPECT_EQ(kept, 1) << "nothing has happened";
    EXPECT_EQ(choice.event(12, 250e3), 12u);
    kept = 0;
    for (int i = 25; i < 50; ++i) kept += choice.keep(i * std::chrono::milliseconds(40), 250e3);
    EXPECT_EQ(kept, 12);
}

}  // namespace
}  // namespace planlight
