// What the banner of the operator's window says has room in it, in every language at every size.
#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <regex>

#include "app/live/not_kept.h"
#include "app/windows/panels.h"
#include "planning_io/files/disk_refusal.h"
#include "projection/light_cause.h"
#include "tests/app/windows/fake_model.h"
#include "tests/app/words/drawn_words.h"
#include "tests/app/words/source_texts.h"

namespace planlight {
namespace {

class BannerInPlace : public DrawnInPlace {
protected:
    void expect_room(const Status& status) {
        OperatorModel model = test::fake_model();
        model.status = status;
        for (const char* notice : {"", "DARK was pressed: the light is out."}) {
            draw_banner(drawn_.pen, drawn_.place.banner, model, notice);
            expect_whole(status.headline + (*notice ? ", with a notice" : ""));
        }
    }
};
INSTANTIATE_TEST_SUITE_P(Windows, BannerInPlace, every_language_and_size());

/// All that the gate says, with figures of two digits.
std::vector<Status> rulings_of_the_gate() {
    std::vector<Status> said;
    for (const std::string& literal :
         test::literals_in(std::filesystem::path(PLANLIGHT_SOURCE_FOLDER) / "projection/light_gate.cpp")) {
        if (!test::is_sentence(literal)) continue;
        const std::string text = std::regex_replace(literal, std::regex("\\{[^{}]*\\}"), "12.3");
        if (text.starts_with("LOOK") || text.starts_with("Dark") || text == "The plan is on the skin.")
            said.push_back({StatusKind::check, text, {}});
        else if (!said.empty())
            said.back().details.push_back(text);
    }
    return said;
}

TEST_P(BannerInPlace, EveryRulingOfTheGateHasRoom) {
    const std::vector<Status> said = rulings_of_the_gate();
    ASSERT_GE(said.size(), 10U);
    for (const Status& status : said) expect_room(status);
}

TEST_P(BannerInPlace, AMatchThatIsNotKeptHasRoomBesideEveryRulingOfTheGate) {
    for (const int why : {ENOSPC, EACCES, EROFS, EIO})
        for (Status status : rulings_of_the_gate()) {
            status.details.push_back(short_words_of_not_kept(
                DiskRefusal("/cases/1", "cannot be written", "Look.", {why, std::generic_category()})));
            expect_room(status);
        }
}

TEST_P(BannerInPlace, EveryCauseOfWrongLightHasRoom) {
    for (int fault = 0; fault <= static_cast<int>(LightFault::light_off); ++fault)
        for (const bool ahead : {false, true}) {
            LightCause cause;
            cause.fault = static_cast<LightFault>(fault);
            cause.size = 12.3, cause.low = 12, cause.high = 112, cause.marker = 9, cause.drawn_ahead = ahead;
            expect_room({StatusKind::check, "LOOK: " + cause.headline(), {cause.sentence(), cause.remedy()}});
            expect_room({StatusKind::dark,
                         "Dark: the patient is not tracked: only 3 of 6 markers seen; 4 are needed.",
                         {cause.sentence(), cause.remedy()}});
        }
}

}  // namespace
}  // namespace planlight
