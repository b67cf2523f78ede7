#include "app/report/html_page.h"

#include <gtest/gtest.h>

namespace planlight {
namespace {

const PageVerdict kLook{PageVerdict::Kind::look, "Calibrated with 1 warning.", {"The <board> was bent."}};

TEST(HtmlPage, SaysFirstWhetherAllIsWellThenWhoWhatAndWhen) {
    const std::string page =
        html_page("Calibration", kLook, {{"Rig", "rig.json"}}, "<h2>Devices</h2>", {"Read and accepted by"});
    std::size_t from = page.find("<body>");
    for (const char* next :
         {"<h1>Calibration</h1>", "Calibrated with 1 warning.", "The &lt;board&gt; was bent.", "rig.json",
          "<span>Operator</span>", "<span>Program</span>Planlight ", "<span>This page made</span>", "<h2>Devices</h2>",
          "Read and accepted by", "Signature", "not a medical device"}) {
        from = page.find(next, from);
        ASSERT_NE(from, std::string::npos) << next << " is missing, or stands too early";
    }
}

TEST(HtmlPage, NamesTheOperatorOfASessionAndNotWhoPrintsIt) {
    const std::string page = html_page("Session", {}, {{"Operator", "left out"}}, "");
    EXPECT_NE(page.find("<span>Operator</span>left out"), std::string::npos);
    EXPECT_EQ(page.find("<span>Operator</span>"), page.rfind("<span>Operator</span>"));
    EXPECT_EQ(page.find("class=\"verdict"), std::string::npos) << "a page that judges nothing has no frame";
    EXPECT_EQ(page.find("Signature"), std::string::npos);
}

}  // namespace
}  // namespace planlight
