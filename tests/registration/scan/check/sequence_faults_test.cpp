#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/registration/scan/spoilt_sequence.h"

// Every kind of fault at every place of the sequences that have less to check them by than the usual one: no inverses,
// or no fringes.
namespace planlight {
namespace {

using namespace spoilt_sequence;
using stripe_room::paper_room, stripe_room::plane, stripe_room::Room, stripe_room::sphere;

const Eigen::Vector3d kCentre(120, -40, 360), kPlace(120, -40, 300);

Room head_room(const Eigen::Vector3d& moved_by = Eigen::Vector3d::Zero()) {
    Room room = paper_room(sphere(kCentre + moved_by, 80));
    room.light.noise_grey = 0;
    return room;
}

Room wall_room() {
    Room room = paper_room(plane(kPlace, Eigen::Vector3d(0.35, 0.2, -1).normalized(), 100));
    room.light.noise_grey = 0;
    room.light.ambient_grey = 60;
    return room;
}

SequenceCheck checked(const Sequence& s, const std::vector<GrayImage>& frames, unsigned seed, double sigma = 1.5) {
    return check_sequence(with_noise(frames, sigma, seed), s.stripes, s.patterns);
}

/// Counts the faults that change more than a tenth of what is lit, and says which pass.
struct Table {
    const Sequence& sequence;
    std::size_t noticed = 0, harmless = 0;
    std::vector<std::string> passed;

    void look(const Fault& fault) {
        if (changed(sequence.frames, fault.frames) < 0.1) {
            ++harmless;
        } else if (const auto check = checked(sequence, fault.frames, static_cast<unsigned>(noticed));
                   !check.problems.empty()) {
            ++noticed;
        } else {
            passed.push_back(fault.what);
        }
    }
    void timing() {
        each_timing_fault(sequence, [this](const Fault& f) { look(f); });
    }
    void exchanges(std::size_t step = 1) {
        for (std::size_t i = 0; i < sequence.frames.size(); i += step)
            each_exchange(sequence, i, [this](const Fault& f) { look(f); });
    }
};

void expect_clean(const Sequence& s, const Sequence& moved) {
    for (unsigned seed = 0; seed < 8; ++seed) {
        const double sigma = 0.5 + 0.4 * seed;  // to 3.3 grey
        const auto check = checked(s, s.frames, seed, sigma);
        EXPECT_TRUE(check.checked);
        EXPECT_TRUE(check.problems.empty()) << "noise " << sigma << ": " << said(check);
    }
    for (std::size_t from = 1; from < s.frames.size(); from += 4) {
        std::vector<GrayImage> frames = s.frames;
        std::copy(moved.frames.begin() + static_cast<std::ptrdiff_t>(from), moved.frames.end(),
                  frames.begin() + static_cast<std::ptrdiff_t>(from));
        const auto check = checked(s, frames, static_cast<unsigned>(from));
        EXPECT_TRUE(check.problems.empty()) << "moved 0.2 mm before " << s.patterns[from].name << ": " << said(check);
    }
}

const Eigen::Vector3d kFifthOfAMillimetre(0.05, 0.05, -0.19);

TEST(SequenceFaults, OfTheFastSetAreNoticedWhereverTheyHappen) {
    for (const bool wall : {false, true}) {
        const Room room = wall ? wall_room() : head_room();
        const Sequence fast = sequence_of(room, fast_stripes(800, 600));
        if (!wall) expect_clean(fast, sequence_of(head_room(kFifthOfAMillimetre), fast.stripes));
        Table table{fast, 0, 0, {}};
        table.timing();
        table.exchanges();
        EXPECT_EQ(table.passed, std::vector<std::string>{});
        EXPECT_GT(table.noticed, 140u);
        EXPECT_LT(table.harmless, 4u);
    }
}

TEST(SequenceFaults, OfAGrayCodeWithoutInversesAreNoticedWhereverTheyHappen) {
    for (const bool wall : {false, true}) {
        const Sequence gray = gray_code_of(wall ? wall_room() : head_room(), 8, false);
        if (!wall) expect_clean(gray, gray_code_of(head_room(kFifthOfAMillimetre), 8, false));
        Table table{gray, 0, 0, {}};
        table.timing();
        table.exchanges();
        EXPECT_EQ(table.passed, std::vector<std::string>{});
        EXPECT_GT(table.noticed, 180u);
        EXPECT_LT(table.harmless, 6u);
    }
}

TEST(SequenceFaults, OfAGrayCodeWithInversesAreNoticedWhereverTheyHappen) {
    const Sequence gray = gray_code_of(head_room(), 8, true);
    expect_clean(gray, gray_code_of(head_room(kFifthOfAMillimetre), 8, true));
    Table table{gray, 0, 0, {}};
    table.timing();
    table.exchanges(4);
    EXPECT_EQ(table.passed, std::vector<std::string>{});
    EXPECT_GT(table.noticed, 240u);
    EXPECT_LT(table.harmless, 6u);
}

// Cells of a projector pixel, here of a camera pixel: the two finest bits of a direction have stripes of two and four
// camera pixels, and of faults among these four pictures nothing is said. All others are noticed.
TEST(SequenceFaults, OfAGrayCodeToSinglePixelsAreNoticedButAmongTheFinestBits) {
    const Sequence gray = gray_code_of(head_room(), 1, false);
    expect_clean(gray, gray_code_of(head_room(kFifthOfAMillimetre), 1, false));
    Table table{gray, 0, 0, {}};
    table.timing();
    for (const std::string& what : table.passed)
        EXPECT_TRUE(what.ends_with("-gray-8") || what.ends_with("-gray-9") || what == "missing at row-gray-7") << what;
    EXPECT_GT(table.noticed, 95u);
    EXPECT_LT(table.passed.size(), 6u);
}

TEST(SequenceFaults, AMirroredOrHalfGrayCodeIsTold) {
    Sequence gray = gray_code_of(head_room(), 8, true);
    ASSERT_EQ(gray.patterns[3].name, "column-gray-0-inverse");
    std::swap(gray.frames[2], gray.frames[3]);  // the coarsest bit inverted: the same code in a mirror
    EXPECT_NE(said(checked(gray, gray.frames, 1)).find("mirror image"), std::string::npos);
    gray.frames[3] = gray.frames[0];
    gray.frames[2] = gray.frames[1];  // never lit: half the code, folded
    EXPECT_NE(said(checked(gray, gray.frames, 1)).find("turns back"), std::string::npos);
}

}  // namespace
}  // namespace planlight
