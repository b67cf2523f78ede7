// The page of an operation and the figures beside it.
#include "app/report/operation_report.h"

#include <sys/stat.h>

#include <cmath>

#include "app/report/report_beside.h"
#include "tests/app/recording_by_hand.h"

namespace planlight {
namespace {

using OperationReport = RecordingByHand;

TEST_F(OperationReport, SaysHowNearWhatWasShownCameToRiskStructuresAsPlanned) {
    event({{"what", "asked"}, {"call", "find_patient"}, {"utc", "2026-03-14T09:31:00Z"}});
    event({{"what", "matched"},
           {"verdict", "yes"},
           {"reasons", json::array()},
           {"residual_rms_mm", 0.3},
           {"points", 20000},
           {"items", {"Line", "Hole"}},
           {"predicted_mm", {0.5, nullptr}},
           {"risk",
            {json::array(),
             {{{"structure", "Dura"}, {"distance_mm", 0.0}, {"through", true}},
              {{"structure", "Nerve"}, {"distance_mm", 7.25}, {"through", false}}}}}});
    for (int i = 0; i <= 20; ++i) lit(0.1, 0.4, "aligned");
    const OperationFacts f = facts();
    ASSERT_EQ(f.items.size(), 2u);
    EXPECT_TRUE(f.items[0].risk.empty());
    EXPECT_EQ(f.items[1].risk, (Clearances{{"Dura", 0, true}, {"Nerve", 7.25, false}}));
    const json figures = json::parse(operation_json(f));
    EXPECT_EQ(figures["items"][1]["risk"][1]["distance_mm"], 7.25);
    const std::string page = page_of(f);
    EXPECT_NE(page.find("next risk structure, as planned"), std::string::npos);
    EXPECT_NE(page.find("<span class=\"stop\">through Dura</span>"), std::string::npos);
}

TEST_F(OperationReport, AReportThatNobodyWaitsForEndsAtOnceAndLeavesNothing) {
    match();
    for (int i = 0; i < 50; ++i) lit(0.2, 0.3, "aligned");
    facts();
    int asked = 0;
    const auto go_on = [&] {
        if (++asked == 20) throw std::runtime_error("the window was closed");
    };
    EXPECT_THROW(write_report_beside(file(), go_on), std::runtime_error);
    EXPECT_EQ(asked, 20);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "the recording alone";
    write_report_beside(file());
    EXPECT_TRUE(fs::exists(fs::path(file()).replace_extension(".html")));
}

TEST_F(OperationReport, OfMoreItemsThanThePageHasRoomForTheWorstAreNamedAndTheGravestWords) {
    OperationFacts f;
    f.updates = 100, f.lit_s = 10, f.aligned_s = 9.5, f.verified = 1;
    for (int i = 0; i < 30; ++i)
        f.items.push_back({"Item " + std::to_string(i),
                           {{0, 10}},
                           10,
                           0.5,
                           {i == 29   ? 1.7
                            : i == 27 ? 0.9
                                      : 0.2},
                           true});
    for (int i = 0; i < 20; ++i) f.said.push_back({1.0 * i, "", "DARK was pressed.", false});
    f.said.push_back({21, "", "The light was stopped: it lies 3 mm beside.", true});
    const std::string html = page_of(f);
    for (const char* name : {"Item 29", "Item 27", "Item 9"})
        EXPECT_NE(html.find(std::string("<td class=\"name\">") + name + "</td>"), std::string::npos) << name;
    EXPECT_EQ(html.find("<td class=\"name\">Item 10</td>"), std::string::npos);
    EXPECT_NE(html.find("none of them farther off"), std::string::npos);
    EXPECT_NE(html.find("The light was stopped"), std::string::npos);
}

TEST_F(OperationReport, AccuracyIsToldInTheTermsOfAstmF2554WhereItWasMeasured) {
    OperationFacts f;
    EXPECT_EQ(in_terms_of_f2554(f), "");
    f.items.push_back({"Line", {{0, 10}}, 10, 0.5, {0.1, 0.2, 0.3}, true});
    f.items.push_back({"Hole", {{0, 10}}, 10, 0.5, {0.6}, true});
    const Deviations of = deviations_of(f);
    EXPECT_EQ(of.count, 4u);
    EXPECT_NEAR(of.mean_mm, 0.3, 1e-12);
    EXPECT_NEAR(of.deviation_mm, std::sqrt(0.14 / 3), 1e-12) << "of a sample: by n - 1";
    EXPECT_NEAR(of.rms_mm, std::sqrt(0.125), 1e-12);
    EXPECT_EQ(of.worst_mm, 0.6);
    EXPECT_NE(in_terms_of_f2554(f).find("mean 0.30 mm, standard deviation 0.22 mm, RMS 0.35 mm, maximum 0.60 mm"),
              std::string::npos)
        << in_terms_of_f2554(f);
    EXPECT_EQ(json::parse(operation_json(f))["f2554"]["count"], 4);
    EXPECT_FALSE(json::parse(operation_json({})).contains("f2554"));
    const std::string html = page_of(f);
    EXPECT_NE(html.find("ASTM F2554"), std::string::npos);
}

// Only so can it be laid beside what the anaesthesia or the navigation recorded.
TEST_F(OperationReport, SaysWhatTheClockOnTheWallWasAtTheBeginningOfItsOwn) {
    const char* was = std::getenv("TZ");
    const std::string zone = was ? was : "";
    ASSERT_EQ(setenv("TZ", "UTC-5:30", 1), 0);  // India: 5.5 h ahead
    tzset();
    const OperationFacts f = facts();
    const std::string html = page_of(f);
    was ? setenv("TZ", zone.c_str(), 1) : unsetenv("TZ");
    tzset();
    EXPECT_EQ(json::parse(operation_json(f))["room_entered"], "2026-03-14T09:30:07Z");
    EXPECT_NE(html.find("<td>Room clock 0:00:00</td><td>2026-03-14 09:30:07 UTC; here 2026-03-14 15:00:07 (UTC+05:30)"),
              std::string::npos);
}

TEST_F(OperationReport, PageAndFiguresStandBesideTheRecordingForItsOwnerOnly) {
    match();
    lit(0.1, 0.2, "aligned");
    lit(0.1, 0.2, "aligned");
    const OperationFacts f = facts();
    const std::string html = page_of(f, "session.html");
    EXPECT_NE(html.find("A &lt;b&gt; title"), std::string::npos) << "a title is text, whatever stands in it";
    EXPECT_NE(html.find(f.recording_hash), std::string::npos);
    for (const char* name : {"session.html", "session.json"}) {
        struct stat status {};
        ASSERT_EQ(::stat((folder_.path() / name).c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 0777, 0600u) << name;
    }
    std::ifstream figures(folder_.path() / "session.json");
    EXPECT_EQ(json::parse(figures)["items"][1]["measured_mm"]["p95"], 0.2);
}

}  // namespace
}  // namespace planlight
