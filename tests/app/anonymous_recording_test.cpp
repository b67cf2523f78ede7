// What an anonymous recording leaves out.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/recording/anonymous.h"
#include "app/recording/recorded_inputs.h"
#include "app/recording/recording_head.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_file.h"
#include "planning_io/recording/recording_reader.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

TEST(Anonymous, OutsideOfThePlansRegionNothingSharpIsLeft) {
    GrayImage face(240, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 240; ++x) face.at(x, y) = static_cast<std::uint8_t>(37 * x * x + 91 * y * x + 13 * y);
    PlanRegion::InPicture region;
    region.pixels = {{100, 80}};
    region.radius_px = 9;
    const GrayImage blurred = blurred_outside(face, region);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 240; ++x) {
            const bool near = std::hypot(x - 100, y - 80) <= 9;
            if (near) {
                EXPECT_EQ(blurred.at(x, y), face.at(x, y));
            }
            // A cell of a mosaic has one grey: its first pixel's, where that is not in the region.
            const int cx = x / 10 * 10, cy = y / 10 * 10;
            if (!near && std::hypot(cx - 100, cy - 80) > 9) {
                EXPECT_EQ(blurred.at(x, y), blurred.at(cx, cy));
            }
        }
    const GrayImage all = blurred_outside(face, {});
    EXPECT_EQ(all.at(100, 80), all.at(109, 89)) << "without a region all of it is blurred";
}

TEST(Anonymous, ALabelWithinThePlansRegionIsBlurredAsTheRest) {
    GrayImage face(240, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 240; ++x) face.at(x, y) = static_cast<std::uint8_t>(37 * x * x + 91 * y * x + 13 * y);
    PlanRegion::InPicture region;
    region.pixels = {{100, 80}};
    region.radius_px = 20;
    region.of_labels = {{106, 80}};
    region.label_radius_px = 4;
    const GrayImage blurred = blurred_outside(face, region), all = blurred_outside(face, {});
    for (int y = 60; y <= 100; ++y)
        for (int x = 80; x <= 120; ++x) {
            const bool label = std::hypot(x - 106, y - 80) <= 4;
            if (std::hypot(x - 100, y - 80) > 20) continue;
            EXPECT_EQ(blurred.at(x, y), (label ? all : face).at(x, y)) << x << ", " << y;
        }
}

TEST(Anonymous, NamesAreLeftOutOfWhatIsSaidAndNotOfItsWords) {
    Case the_case;
    the_case.code = "1234-abcd";
    the_case.names.patient = "Erika \"M.\"";
    the_case.names.title = "aligned";  // a title may be any word
    the_case.plan.risk_structures = {{"Erika's nerve", {}}};
    PlanDrawing drawing;
    drawing.items.resize(2);
    drawing.items[0].name = "Erika's hole";
    drawing.items[1].name = "Erika";
    NamesLeftOut names(the_case);
    names.add_items(drawing);
    const auto out = nlohmann::json::parse(names.out_of(
        R"({"what":"gate","trust":"aligned","headline":"\"Erika's hole\" of Erika \"M.\" is not measured","items":["Erika's hole","Erika"],"risk":[[{"structure":"Erika's nerve"}]]})"));
    EXPECT_EQ(out["risk"][0][0]["structure"], "structure 1");
    EXPECT_EQ(out["trust"], "aligned");
    EXPECT_EQ(out["items"], nlohmann::json({"item 1", "item 2"}));
    EXPECT_EQ(out.dump().find("Erika"), std::string::npos) << out;
}

/// A version "1.0" or an item "A" is found in figures and words, and must not take them with it.
TEST(Anonymous, LeavesFiguresTimesAndWordsAsTheyAre) {
    Case the_case;
    the_case.code = "10";
    the_case.names.patient = "Li";
    the_case.names.plan_version = "1.0";
    PlanDrawing drawing;
    drawing.items.resize(1);
    drawing.items[0].name = "A";
    NamesLeftOut names(the_case);
    names.add_items(drawing);
    const auto out = nlohmann::json::parse(names.out_of(
        R"({"utc":"2026-10-10T10:10:10Z","rig_hash":"10ab","said":"\"A\" of Li lies 1.0 mm off, 11.04 at 10 s: LOOK At the Light","version":"1.0","items":["A"],"case":"Meier"})"));
    EXPECT_EQ(out["utc"], "2026-10-10T10:10:10Z");
    EXPECT_EQ(out["rig_hash"], "10ab");
    EXPECT_EQ(out["said"], "\"item 1\" of … lies 1.0 mm off, 11.04 at 10 s: LOOK At the Light");
    EXPECT_EQ(out["version"], "…");
    EXPECT_EQ(out["items"][0], "item 1");
}

/// Capital letters are told from small ones in every script that has them, and where it has none every word is meant.
TEST(Anonymous, PartsOfANameAreLeftOutInAnyScript) {
    const auto without = [](const char* name, const char* text) {
        NamesLeftOut names{Case{}};
        names.add_person(name);
        return names.text_without(text);
    };
    EXPECT_EQ(without("Łukasz^Żak", "Patient Łukasz Żak, ŁUKASZ."), "Patient … …, ….");
    EXPECT_EQ(without("ŠIMEK^JAN", "Šimek was here; ŠIMEK; Jan"), "… was here; …; …");
    EXPECT_EQ(without("ČAPEK^KAREL", "Čapek"), "…");
    EXPECT_EQ(without("Ёлкин^Пётр", "Ёлкин лежит, ЁЛКИН, Пётр"), "… лежит, …, …");
    EXPECT_EQ(without("Παπαδόπουλος^Γιώργος", "Παπαδόπουλος, ΓΙΏΡΓΟΣ"), "…, …");
    EXPECT_EQ(without("Özdemir^İbrahim", "Özdemir İbrahim, ÖZDEMİR"), "… …, …");
    EXPECT_EQ(without("王^小明", "小明 lies still"), "… lies still");
    EXPECT_EQ(without("محمد^علي", "\"محمد\" lies still"), "\"…\" lies still");
    EXPECT_EQ(without("Łąka", "łąka jest zielona"), "łąka jest zielona") << "small: a word, if it were one";
    EXPECT_EQ(without("Meier", "\xff Meier"), "\xEF\xBF\xBD …") << "what is no UTF-8 hides no name";
}

/// Scanners write MEIER^HANS, people Meier: each part is left out, and the words that are spelt as it are not.
TEST(Anonymous, PartsOfANamePeopleAndFoldersAreLeftOutAndWordsSpeltAlikeAreNot) {
    Case the_case;
    the_case.code = "1234-abcd";
    the_case.names.patient = "MEIER-LONG^ÄNNE^^DR";
    the_case.plan.boreholes.resize(1);
    the_case.plan.boreholes[0].name = "Annes hole";
    NamesLeftOut names(the_case);
    names.add_person("Dr. Xaver Light");
    names.add_person("or-kranich");
    names.add_person("王^小明");
    names.add_place("/srv/cases/m17/");
    const auto without = [&](const char* text) { return names.text_without(text); };
    EXPECT_EQ(without("Meier lies still, änne too"), "… lies still, änne too") << "small: a word, if it were one";
    EXPECT_EQ(without("Änne Meiers scan"), "… …s scan");
    EXPECT_EQ(without("/home/xaver/scan.ply and /srv/cases/m17/plan.json"), "/home/…/scan.ply and …/plan.json");
    EXPECT_EQ(without("a long way, the light of a meiersche pole"), "a long way, the light of a meiersche pole");
    EXPECT_EQ(without("Light on the skin"), "Light on the skin") << "our own word names nobody";
    EXPECT_EQ(without("Xaver's camera at KRANICH is away"), "…'s camera at … is away");
    EXPECT_EQ(without("found 小明, by 王"), "found …, by …") << "such letters are neither large nor small";
    EXPECT_EQ(without("\"Annes hole\" is out of the light"), "\"item 1\" is out of the light") << "before any match";
    const auto room = nlohmann::json::parse(
        names.out_of_room(R"({"name":"Theatre of Prof. Huber","notes":["ask Huber"],"rig_hash":"ab"})"));
    EXPECT_EQ(room["name"], "");
    EXPECT_TRUE(room["notes"].empty());
    EXPECT_EQ(room["rig_hash"], "ab");
}

/// A session in the simulated room, recorded without names and faces.
TEST(AnonymousRecording, HoldsNoNameAndNoFace) {
    if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    const test::TemporaryFolder folder;
    const fs::path file = folder.path() / "anonymous.plrec";
    test::ExampleCase patient = test::example_case();
    Case& named = patient.prepared;
    named.names.patient = "Xaverl Q.", named.names.title = "Xaverl's head";
    for (auto& hole : named.plan.boreholes) hole.name = "Xaverl's " + hole.name;
    {
        RecordingHead head = recording_head(named, "/home/xaverl/cases", RecordMode::events, {});
        NamesLeftOut names(named);
        names.add_place(head.case_folder);
        SessionRecorder recorder(std::make_unique<RecordingFile>(file), without_names(head), {}, {}, names);
        test::PlayedSession how;
        how.seed = 31;
        how.updates = 20;
        how.doubt = "Xaverl's camera, of /home/xaverl/cases/rig.json, is late";
        test::play_session(how, patient, &recorder);
    }
    RecordingReader reader(file);
    int frames = 0, sharp = 0;
    bool items_named = false, doubted = false;
    while (const auto chunk = reader.next()) {
        EXPECT_NE(chunk->type, chunk_types::kMatch);
        EXPECT_NE(chunk->type, chunk_types::kPicture) << "the names of the items stand in it as light";
        if (chunk->type == chunk_types::kEvent || chunk->type == chunk_types::kHead ||
            chunk->type == chunk_types::kRoom) {
            EXPECT_EQ(chunk->payload.find("averl"), std::string::npos) << chunk->payload.substr(0, 300);
            items_named |= chunk->payload.find("\"item 2\"") != std::string::npos;
        }
        if (chunk->type == chunk_types::kInputs) {
            EXPECT_EQ(chunk->payload.find("averl"), std::string::npos) << "a device may name a file";
            for (const RecordedInput& input : unpacked_inputs(chunk->payload, file))
                doubted |= input.kind == RecordedInput::Kind::doubt && input.text.ends_with("is late");
        }
        if (chunk->type != chunk_types::kFrame) continue;
        ++frames;
        const StereoFrame frame = unpack_frame(chunk->payload, file);
        // Neighbours that differ: none within a cell of the mosaic.
        std::size_t differ = 0;
        for (int y = 0; y < frame.left.height; ++y)
            for (int x = 0; x + 1 < frame.left.width; ++x)
                differ += (x + 1) % 31 != 0 && frame.left.at(x, y) != frame.left.at(x + 1, y);
        const double share = static_cast<double>(differ) / static_cast<double>(frame.left.pixels.size());
        EXPECT_LT(share, 0.35) << "the example's plan covers less than a third of the picture";
        sharp += share > 0.01;
    }
    EXPECT_TRUE(doubted);
    EXPECT_TRUE(items_named) << "of items without a name there is nothing to be left out";
    EXPECT_GT(frames, 3);
    EXPECT_GT(sharp, 0) << "round the plan the light can be looked at";
}

}  // namespace
}  // namespace planlight
