#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "app/evaluation/chain_report.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// A room with errors of its own, as a run of the chain would leave it.
ChainFigures room(unsigned seed, const std::string& preset = "paper") {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0, 0.1 + 0.05 * seed);
    const auto some = [&](int count) {
        std::vector<double> values;
        for (int i = 0; i < count; ++i) values.push_back(std::abs(error(random)));
        return values;
    };
    ChainFigures figures;
    figures.preset = preset;
    figures.seed = seed;
    figures.initial_match_right = true;
    figures.registration.emplace();
    figures.registration->verdict = seed % 2 ? Verdict::yes : Verdict::ask;
    figures.scan_error_mm = some(4000);
    figures.tre_mm = some(12);
    figures.tre_of_bound = some(12);
    figures.at_rest.position_mm = some(300);
    figures.moving.position_mm = some(300);
    figures.tracking_error_mm = some(100);
    figures.at_rest.tick_mm = some(20);
    figures.at_rest.diameter_percent = some(4);
    figures.at_rest.angle_deg = some(8);
    figures.update_s = some(50);
    figures.moving_dark = static_cast<int>(seed);
    return figures;
}

class MergeReports : public testing::Test {
protected:
    MergeReports() : folder_(fs::temp_directory_path() / ("planlight-merge-" + std::to_string(::getpid()))) {
        fs::create_directories(folder_);
    }
    ~MergeReports() override { fs::remove_all(folder_); }
    fs::path report(const std::string& name, const std::vector<ChainFigures>& rooms, const std::string& code = "1f3c") {
        Preparation prepared;
        prepared.prepared.code = code;
        write_report_json(folder_ / name, prepared, rooms);
        return folder_ / name;
    }
    void expect_refused(const std::vector<fs::path>& reports, const std::string& about) {
        try {
            merge_reports(reports, folder_ / "never.json");
            FAIL() << "not refused: " << about;
        } catch (const InputError& refusal) {
            EXPECT_NE(std::string(refusal.what()).find(about), std::string::npos) << refusal.what();
        }
        EXPECT_FALSE(fs::exists(folder_ / "never.json"));
    }
    fs::path folder_;
};

// The same rooms in one run: counts and worst values to the last bit, quantiles to half a bin of one per cent.
TEST_F(MergeReports, PartsSayWhatOneRunOfAllSeedsSays) {
    const auto whole = summarise({room(1), room(2), room(3), room(4)}, "paper");
    const auto parts = merge_reports({report("a.json", {room(1), room(2)}), report("b.json", {room(3), room(4)})},
                                     folder_ / "joined.json");
    ASSERT_EQ(parts.size(), 1u);
    const PresetSummary& joined = parts.front();
    EXPECT_EQ(joined.rooms, 4u);
    EXPECT_EQ(joined.said_yes, 2u);
    EXPECT_EQ(joined.said_ask, 2u);
    EXPECT_EQ(joined.dark_updates, whole.dark_updates);
    ASSERT_EQ(joined.rows.size(), whole.rows.size());
    for (std::size_t i = 0; i < whole.rows.size(); ++i) {
        const Distribution &a = joined.rows[i].found, &b = whole.rows[i].found;
        EXPECT_EQ(a.count, b.count) << whole.rows[i].name;
        EXPECT_EQ(a.worst, b.worst) << whole.rows[i].name;
        EXPECT_NEAR(a.median, b.median, 0.0051 * b.median) << whole.rows[i].name;
        EXPECT_NEAR(a.p95, b.p95, 0.0051 * b.p95) << whole.rows[i].name;
    }
}

TEST_F(MergeReports, WhatIsJoinedCanBeJoinedAgain) {
    merge_reports({report("a.json", {room(1)}), report("b.json", {room(2, "modern")})}, folder_ / "ab.json");
    const auto all = merge_reports({folder_ / "ab.json", report("c.json", {room(3)})}, folder_ / "abc.json");
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].rooms + all[1].rooms, 3u);
}

TEST_F(MergeReports, WhatDoesNotBelongTogetherIsRefusedByName) {
    const auto a = report("a.json", {room(1), room(2)});
    expect_refused({a, report("b.json", {room(2), room(3)})}, "paper 2");
    expect_refused({a, report("other.json", {room(5)}, "77aa")}, "another case");
    std::ofstream(folder_ / "none.json") << "{\"format\": \"planlight truth\"}";
    expect_refused({a, folder_ / "none.json"}, "none.json");
    std::ofstream(folder_ / "cut.json") << "{\"format\"";
    expect_refused({folder_ / "cut.json"}, "cut.json");
}

TEST_F(MergeReports, ARoomWithoutItsFiguresIsRefused) {
    std::ifstream in(report("a.json", {room(1)}));
    std::string text{std::istreambuf_iterator<char>(in), {}};
    for (std::size_t at; (at = text.find("\"bins\"")) != std::string::npos;) text.replace(at, 6, "\"gone\"");
    std::ofstream(folder_ / "old.json") << text;
    expect_refused({folder_ / "old.json"}, "old.json");
}

}  // namespace
}  // namespace planlight
