// The languages that come with the program: whole, and true to what the sources say.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "app/live/session_states.h"
#include "app/words/words.h"
#include "planning_io/types/error.h"
#include "tests/app/source_refusals.h"
#include "tests/app/words/said_in_the_window.h"
#include "tests/app/words/source_texts.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = PLANLIGHT_SOURCE_FOLDER;

std::map<std::string, std::string> entries_of(const std::string& code) {
    std::map<std::string, std::string> entries;
    for (const auto& [english, own] : read_language(shipped_words(code), code).words) {
        EXPECT_FALSE(entries.contains(english)) << "twice in " << code << ": " << english;
        entries[english] = own;
    }
    return entries;
}

class ShippedWords : public testing::TestWithParam<const char*> {
protected:
    const std::shared_ptr<const Words> words_ = words_of(GetParam());
    void expect_known(const std::string& text, const std::string& where) const {
        const auto said = test::as_said(text);
        EXPECT_TRUE(std::any_of(said.begin(), said.end(), [&](const std::string& one) { return words_->knows(one); }))
            << where << ": " << text;
    }
};
INSTANTIATE_TEST_SUITE_P(Languages, ShippedWords, testing::Values("de", "ru"));

TEST_P(ShippedWords, HaveEveryEntryOfTheSourceAndNoOther) {
    const auto english = entries_of("en"), own = entries_of(GetParam());
    for (const auto& [text, same] : english) {
        EXPECT_EQ(text, same) << "English is the source";
        EXPECT_TRUE(own.contains(text)) << text;
    }
    for (const auto& [text, translated] : own) {
        EXPECT_TRUE(english.contains(text)) << text;
        EXPECT_FALSE(translated.empty()) << text;
    }
}

// A word that stands for two states would be read as the wrong one.
TEST_P(ShippedWords, NoTwoWordsOfTheBannerAreTheSame) {
    std::set<std::string> said;
    for (const char* word : {"READY", "SCANNING", "MATCHING", "ALIGNED", "CHECK", "REFUSED", "DARK", "WAIT"})
        EXPECT_TRUE(said.insert(words_->say(word)).second) << words_->say(word);
    std::set<std::string> sides;
    for (const char* side : {"LEFT", "RIGHT", "BOTH SIDES", "MIDDLE"}) sides.insert(words_->say(side));
    EXPECT_EQ(sides.size(), 4U);
}

TEST_P(ShippedWords, SayEveryStateAndEveryReasonOfTheTable) {
    for (const SessionState state : kSessionStates) {
        const SessionView& view = view_of(state);
        for (const char* text :
             {view.headline, view.what_next, view.no_scan, view.no_register, view.no_track, view.no_stop})
            if (text != nullptr) expect_known(text, view.name);
        for (int press = 0; press <= static_cast<int>(OperatorAction::show_item); ++press)
            expect_known(why_not(state, static_cast<OperatorAction>(press)), view.name);
        for (const Status& status : {dark_status(state)}) {
            expect_known(status.headline, view.name);
            for (const std::string& detail : status.details) expect_known(detail, view.name);
        }
    }
}

/// A fault of the program's own, not for a person at the trolley: "capture_scan: stripes of ...".
bool of_a_function(const std::string& text) {
    static const std::regex kFunction("^[a-z]+(_[a-z]+)+: .*");
    return std::regex_match(text, kFunction);
}

/// The text is a part of an entry: its words between placeholders stand there in their order.
bool is_part_of_an_entry(const std::string& text, const std::map<std::string, std::string>& entries) {
    static const std::regex kPlace("\\{[^{}]*\\}");
    std::vector<std::string> pieces(std::sregex_token_iterator(text.begin(), text.end(), kPlace, -1), {});
    for (std::string& piece : pieces) {
        while (!piece.empty() && (piece.back() == ' ' || piece.back() == '.' || piece.back() == ':')) piece.pop_back();
        while (!piece.empty() && piece.front() == ' ') piece.erase(0, 1);
    }
    return std::any_of(entries.begin(), entries.end(), [&](const auto& entry) {
        std::size_t at = 0;
        for (const std::string& piece : pieces) {
            std::string capital = piece, small = piece;
            if (!piece.empty()) capital[0] = static_cast<char>(std::toupper(piece[0]));
            if (!piece.empty()) small[0] = static_cast<char>(std::tolower(piece[0]));
            at = std::min(entry.first.find(capital, at), entry.first.find(small, at));
            if (at == std::string::npos) return false;
            at += piece.size();
        }
        return true;
    });
}

// An item of the plan may be called as a button is.
TEST_P(ShippedWords, LeaveANameAsItIsThatIsAWordOfTheWindow) {
    static const std::regex kName("\\{name[0-9]*\\}"), kNumber("\\{[^{}]*\\}");
    ASSERT_NE(words_->say("Track"), "Track");
    int names = 0;
    for (const auto& [english, same] : entries_of("en")) {
        if (english.find("{name") == std::string::npos || english.find("{words") != std::string::npos) continue;
        const std::string text = std::regex_replace(std::regex_replace(english, kName, "Track"), kNumber, "7");
        EXPECT_NE(words_->say(text).find("Track"), std::string::npos) << text << " -> " << words_->say(text);
        EXPECT_NE(words_->say(text + ".").find("Track"), std::string::npos) << text;
        ++names;
    }
    EXPECT_GT(names, 50);
}

TEST_P(ShippedWords, SayWhatTheSourcesOfTheWindowSay) {
    const auto entries = entries_of("en");
    for (const char* file : test::kSaying)
        for (const std::string& text : test::literals_in(kRoot / file))
            if (test::is_sentence(text) && !test::kNotShown.contains(text) && !of_a_function(text) &&
                !is_part_of_an_entry(text, entries))
                expect_known(text, file);
}

// Every refusal of what a session does, with its remedy.
TEST_P(ShippedWords, SayEveryRefusalOfASession) {
    const auto entries = entries_of("en");
    std::size_t refusals = 0;
    for (const test::SourceRefusal& refusal : test::refusals_in_sources(kRoot)) {
        const bool said = std::any_of(std::begin(test::kSaying), std::end(test::kSaying),
                                      [&](const char* file) { return refusal.file == file; });
        if (!said || refusal.problem == "…") continue;
        ++refusals;
        for (std::string text : {refusal.problem, refusal.remedy}) {
            text = std::regex_replace(text, std::regex("…"), "{}");
            if (test::kNotShown.contains(text) || text == "{}") continue;
            if (!is_part_of_an_entry(text, entries)) expect_known(text, refusal.file);
        }
    }
    EXPECT_GT(refusals, 25U);
}

// As they are put together when they are said, with figures, names and reasons.
TEST_P(ShippedWords, SayWholeSentencesAsASessionPutsThemTogether) {
    for (const char* text :
         {"Track is not possible now: register first.",
          "2026-03-14T09:30:00Z \u00b7 2402 frames were kept",
          "Saved as 2026-03-14T09-30-00Z-at-95.000.png, beside the recording.",
          "The picture could not be saved: a.png: cannot be written: Permission denied.",
          "The recording stands still: No space left on device. 12 pieces are missing; the light is not affected.",
          "The recording is being ended.",
          "A slow disk is given ten seconds.",
          "An anonymous recording does not keep where the plan lies.",
          "No patient had been found by then.",
          "Where the head was at that moment is not known: the plan was not followed.",
          "Borehole 1: left: no light was found here",
          "Borehole 1: left: 0.31 mm beside the plan (± 0.12 mm, one standard deviation)",
          "Light was found at 60 of 66 places; half of them lie within 0.10 mm of the plan, 95 % within 0.31 mm.",
          "1 of 4 items were hidden, and are not looked for. None of the plan's light was found in this frame, at 66 "
          "places where it should be seen: it had only just been asked for, or something was before it.",
          "It was dark. There is no light of the plan to look for.",
          "Landmark 1 alone was lit.",
          "Only \"Borehole 1\" was bright, and that alone is looked for.",
          "The recording ends without a closing word, 812 chunks long: the session was stopped from outside, or the "
          "disk was full.",
          "Green: The plan is on the skin.",
          "Amber: LOOK: the light comes late.",
          "Dark: the light went out.",
          "Match: yes, the worst item within 0.4 mm (95 %).",
          "The light cannot be verified: Only one of the two places to look at can be lit and seen by both cameras. "
          "Uncover more of the head or turn it, and scan again.",
          "Check skin is not possible now: the light does not follow the patient.",
          "Dark: the patient is not tracked: only 3 of 6 markers seen; 4 are needed.",
          "Dark: the last pose is 82 ms old (at most 75 ms).",
          "Dark: Left camera (serial 4711): no frame came in 250 ms.",
          "Left camera: its pictures come 40 ms late.",
          "No projector: monitor HDMI-2 is no longer connected.",
          "No projector: Projector process: it was ended from outside, or crashed.",
          "LOOK: the light comes late.",
          "Osteotomy: about 25 % of it has no light (behind other skin); it goes on where the light ends.",
          "Turn the patient or the projector to light the rest.",
          "The light comes 25 to 40 ms later than the projector promises.",
          "LOOK: \"Borehole 1: left\" lies 1.3 mm beside its place.",
          "LOOK: \"Borehole 1: left\" is measured in part only.",
          "The skin there stands 2.5 mm higher than at the scan.",
          "The cameras can see about 30 % of its light: look at the rest yourself.",
          "only 3 markers were found by both cameras; 5 are needed.",
          "the markers were lost during the scan: only 3 of 6 markers seen; 4 are needed.",
          "the patient moved 0.25 mm during the scan, and in the 2 before it as well.",
          "the rig cannot be trusted: the projector moved, or the left camera moved since the calibration of "
          "2026-03-01 (by "
          "0.31 mm and 0.012 degrees; 0.20 mm and 0.010 degrees); one scan cannot tell which; light may be off by up "
          "to "
          "1.20 mm without a sign of it.",
          "the left camera moved or its lens was changed (focus, zoom or shift) since the calibration (by +0.31 % of "
          "its "
          "focal length)",
          "the projector and the left camera moved since the calibration of today (by 0.31 mm and 0.012 degrees)",
          "that is more than a bump: another rig, a picture under keystone correction, or a code that begins "
          "elsewhere.",
          "the left camera's frames do not show the sequence: white is not the brightest (12 % of the lit pixels).",
          "the last match is not used: the markers are not as they were: the markers seen do not determine a pose.",
          "the last match is not used: the rig has moved since: the projector moved since the calibration (by 3.1 mm "
          "and "
          "0.012 degrees).",
          "The skin lies 0.4 mm inside of that of the CT, and has moved by 0.2 mm (rms).",
          "the head of the scan fits the CT better when it is stretched, sheared or twisted, and light could lie 1.9 "
          "mm off: another patient, one who moved during the CT, a distorted MR or a wrong calibration: look at the "
          "light on landmarks",
          "the patient could turn about the left-right axis by 1.9 mm unnoticed: scan forehead and chin, or an ear as "
          "well",
          "the scan alone: another pose fits nearly as well (ratio 1.13)",
          "Next best other pose fits inf times worse; 4 independent bases agree.",
          "It belongs there: at the front of the head, on the patient's left, towards the crown (see the picture of "
          "the head). If it lies elsewhere on the patient, "
          "press "
          "Stop, and scan again.",
          "The skin was not checked: the markers were not seen: only 3 of 6 markers seen; 4 are needed; check it "
          "again.",
          "Right frontal, version 3 · series of 2012-09-14",
          "Warning: Over 22 square cm (most at the forehead, the left side) what lies just under the surface is "
          "lighter than skin and fat: hair, a strap, a cloth or a cover lies on the skin there. Look at the skin "
          "in the report before you use it.",
          "Warning: The volume ends within the head: it cuts off the face (31 square cm), the right side (9 square "
          "cm); what lies there is no skin. Scan, match and draw elsewhere, or give a series that shows the whole "
          "head.",
          "Warning: At the left side the volume ends over 12 square cm within something that has no bone under it "
          "nor round it: something lies on the head there (a cushion, wet hair, a blanket). Look at the skin in "
          "the report before you use it.",
          "Warning: The crown is low for a head 150 mm broad and 190 mm long (0.61; heads have 0.8 to 1.1): the "
          "distance of the slices in the file may be wrong. Compare the voxel size in the file with what the "
          "scanner was set to; convert the series again from DICOM.",
          "Warning: Between two slices across head and feet, at 42 mm, the whole outline jumps: what follows is "
          "shifted by 3.1 mm and turned by 1.2 degrees. The patient seems to have moved while the series was "
          "taken, and the skin of one side of that place does not fit the other. Give a series in which the "
          "patient lay still; look at the skin in the report.",
          "Warning: Whether something lies on the skin (at one side, small things) could not be asked: too little "
          "of the head is in the volume. Look at the skin in the report before you use it.",
          "Warning: The skin is uncertain in places: 9 % of the outline moves by more than 3 mm when the threshold "
          "is taken at 0.7 or 1.5 times what was found (1234). Try `planlight prepare --threshold 864` and 1851, "
          "and compare the pictures of the report.",
          "Warning: The greys of this CT are not quite HU, as a cone-beam CT's are: soft tissue lies at -210 and "
          "not near 35. Bone was looked for at 120 and above. Look at the skin in the report before you use it.",
          "Warning: the values of this CT are not HU; the skin threshold 512 was found from their histogram: look "
          "at the skin before you use it",
          "Warning: the file does not say whether it is CT or MR: taken for MR (its least value is 0, and the air "
          "of a CT in HU near -1000)",
          "Warning: of two large pieces in the volume the larger was taken for the phantom (1200 ml), and the "
          "other left out (900 ml). Look at the skin: a couch may be the larger",
          "Warning: not every name has room in the light, or can be lit. In its place stands: B1 is Borehole 1: "
          "left, T1 is Way. Each item's code stands beside its name in the window, too",
          "Warning: the plan is crowded: the names of 3 of 40 items find no free skin, and are not written there",
          "Warning: left aside: 1 localizer picture of the series",
          "Warning: left aside: 2 DICOM files that are damaged and do not say of which series: if a slice at the "
          "end of this one is among them, the volume ends before it",
          "Warning: its 41 slices lie 2.40 to 5.10 mm apart; they were laid onto an even grid of 80 with steps of "
          "2.41 mm, linear between the cuts: where they are far apart the skin is coarser",
          "Warning: skin.stl: at 12 edges three triangles or more meet",
          "Room 2 · 93e8e8b7 of 2026-03-14 · 1 cutting line, 4 boreholes, 1 trajectory",
          "Warning: Borehole 1: 12 % of it lies where the scan saw no skin; the skin there is taken to lie 0.4 mm "
          "inside that "
          "of the CT, as most of the rest does, give or take 0.8 mm (95 %)"})
        EXPECT_TRUE(words_->knows(text)) << text << "\n  -> " << words_->say(text);
}

}  // namespace
}  // namespace planlight
