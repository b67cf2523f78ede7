#include "tests/app/recorded_kinds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "app/recording/recording_head.h"
#include "app/recording/resume_offer.h"
#include "app/session_observers.h"
#include "planning_io/recording/recording_reader.h"

namespace planlight::test {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFaultAfter = 10;
constexpr std::array<std::string_view, 10> kShort{"items hidden and lit alone, a card on the skin",
                                                  "the match of a session before is gone on with",
                                                  "DARK in the scan",
                                                  "wrong landmarks: not found",
                                                  "a doubtful match, confirmed",
                                                  "a doubtful match, refused",
                                                  "the patient moves in each scan: refused",
                                                  "a hand over all markers, and away",
                                                  "cameras that doubt themselves",
                                                  "a camera lost, and back"};

RecordedKind kind(std::string name, unsigned seed, int updates, std::vector<std::string> must_hold) {
    RecordedKind made;
    made.name = std::move(name);
    made.how.seed = seed;
    made.how.updates = updates;
    made.how.speed_mm_s = 0;  // a moving head costs the simulator ten times as much: three of the twenty have one
    made.must_hold = std::move(must_hold);
    return made;
}

RecordedKind faulty(std::string name, unsigned seed, int updates, const std::string& fault,
                    std::vector<std::string> must_hold) {
    RecordedKind made = kind(std::move(name), seed, updates, std::move(must_hold));
    made.how.fault = fault;
    made.how.fault_after = kFaultAfter;
    return made;
}

std::vector<RecordedKind> without_faults() {
    std::vector<RecordedKind> kinds;
    kinds.push_back(kind("the head moves, the skin is checked", 1, 20, {R"({"what":"skin_checked","known":true)"}));
    kinds.back().how.check_skin = true;
    kinds.back().how.speed_mm_s = 20;
    kinds.push_back(kind("items hidden and lit alone, a card on the skin", 5, 60,
                         {R"("call":"hide_item")", R"("call":"light_item")", R"("call":"show_item")"}));
    kinds.back().how.hide_items = true;
    kinds.back().how.card = {"E. M.", "RIGHT"};
    kinds.back().how.exposures_told = true;
    kinds.push_back(
        kind("a head that moves at 60 mm/s", 26, 16, {R"({"what":"updated")", R"("what":"gate","call":"step")"}));
    kinds.back().how.speed_mm_s = 60;
    kinds.push_back(kind("the modern room", 22, 12, {R"({"what":"updated")", R"("lit":true)"}));
    kinds.back().how.preset = simulation::Preset::modern;
    kinds.push_back(kind("the match of a session before is gone on with", 21, 20, {R"({"what":"resumed")"}));
    kinds.back().resumed = true;
    return kinds;
}

void add_what_people_do(std::vector<RecordedKind>& kinds) {
    using Look = PlayedSession::Look;
    kinds.push_back(
        kind("DARK in the scan", 2, 20, {R"({"what":"asked","call":"go_dark")", R"({"what":"refused","call":"scan")"}));
    kinds.back().how.dark_in_scan = true;
    kinds.push_back(kind("wrong landmarks: not found", 4, 0, {R"({"what":"matched","verdict":"no")"}));
    kinds.back().how.landmarks = true;
    kinds.push_back(kind("a doubtful match, confirmed", 19, 20,
                         {R"({"what":"matched","verdict":"ask")", R"({"what":"asked","call":"confirm")"}));
    kinds.back().how.look = Look::confirmed;
    kinds.push_back(kind("a doubtful match, refused", 20, 0, {R"({"what":"matched","verdict":"ask")"}));
    kinds.back().how.look = Look::refused;
    kinds.push_back(kind("the patient moves in each scan: refused", 17, 0,
                         {R"({"what":"refused","call":"scan","why":"the patient moved)"}));
    kinds.back().how.moves_in_scan = true;
    kinds.push_back(kind("a hand before the head: refused", 8, 0, {R"({"what":"refused")"}));
    kinds.back().how.things.hand = true;
    kinds.push_back(faulty("a hand over all markers, and away", 7, 40, "hand-over-markers",
                           {R"("rig_from_patient":null)", R"("lit":false)"}));
}

void add_what_devices_do(std::vector<RecordedKind>& kinds) {
    kinds.push_back(kind("cameras that doubt themselves", 6, 30, {R"({"what":"updated")"}));
    kinds.back().how.doubt = "left camera: its pictures come 40 ms late";
    kinds.push_back(faulty("a camera lost, and back", 9, 30, "camera-away",
                           {R"({"what":"refused","call":"update","why":"Left camera: no frame)"}));
    kinds.push_back(faulty("the right camera bumped", 10, 40, "right-camera", {R"("fault":"right_camera_moved")"}));
    kinds.push_back(faulty("a picture that comes late", 3, 60, "late", {R"("fault":"late_picture")"}));
    kinds.back().how.speed_mm_s = 20;  // at rest a late picture falls where a punctual one does
    kinds.push_back(faulty("the projector bumped", 14, 40, "projector", {R"("fault":"projector_moved")"}));
    kinds.push_back(faulty("the left camera bumped", 15, 40, "left-camera", {R"("fault":"left_camera_moved")"}));
    kinds.push_back(faulty("a marker slipped", 12, 40, "marker", {R"("fault":"marker_slipped")"}));
    kinds.push_back(faulty("a lid before the projector", 18, 40, "no-picture", {R"("fault":"no_picture")"}));
}

/// The last bit of the last number of a matrix of 16 that is not of its last row.
bool move_by_one_bit(Json& matrix) {
    if (!matrix.is_array() || matrix.size() != 16) return false;
    const double was = matrix[11].get<double>();
    matrix[11] = std::nextafter(was, std::numeric_limits<double>::infinity());
    return true;
}

std::vector<std::size_t> events_that_begin(const std::vector<RecordingChunk>& chunks, const std::string& begin,
                                           const std::string& holds = {}) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < chunks.size(); ++i)
        if (chunks[i].type == chunk_types::kEvent && chunks[i].payload.starts_with(begin) &&
            chunks[i].payload.find(holds) != std::string::npos)
            found.push_back(i);
    return found;
}

std::optional<Tampered> tamper_pose(std::vector<RecordingChunk>& chunks) {
    const auto poses = events_that_begin(chunks, R"({"what":"updated")", R"("rig_from_patient":[)");
    if (poses.empty()) return std::nullopt;
    const std::size_t middle = poses[poses.size() / 2];
    Json event = Json::parse(chunks[middle].payload);
    if (!move_by_one_bit(event["pose"]["rig_from_patient"])) return std::nullopt;
    chunks[middle].payload = event.dump();
    const auto asked = events_that_begin(chunks, R"({"what":"asked","call":"update")");
    const auto before = std::ranges::count_if(asked, [&](std::size_t at) { return at < middle; });
    return Tampered{static_cast<int>(before), event["number"].get<std::uint64_t>(), "pose.rig_from_patient.11"};
}

}  // namespace

const std::vector<RecordedKind>& recorded_kinds() {
    static const std::vector<RecordedKind> all = [] {
        std::vector<RecordedKind> kinds = without_faults();
        add_what_people_do(kinds);
        add_what_devices_do(kinds);
        for (RecordedKind& kind : kinds) kind.is_long = std::ranges::find(kShort, kind.name) == kShort.end();
        return kinds;
    }();
    return all;
}

PlayedResult record_kind(const RecordedKind& kind, const ExampleCase& patient, const std::filesystem::path& file,
                         SessionObserver* beside) {
    std::optional<ResumeOffer> offer;
    if (kind.resumed) {
        constexpr int kFew = 2;
        PlayedSession before = kind.how;
        before.updates = kFew;
        const auto recording = std::filesystem::path(file).replace_extension(".before.plrec");
        record_session(before, patient, RecordMode::events, recording);
        offer = resume_offer(recording, patient.prepared);
    }
    DrawingSettings drawing;
    drawing.card = kind.how.card;
    SessionRecorder recorder(std::make_unique<RecordingFile>(file),
                             recording_head(patient.prepared, file.parent_path(), RecordMode::all, drawing));
    SessionObservers both;
    both.add(&recorder);
    both.add(beside);
    return play_session(kind.how, patient, both.all(), offer);
}

std::vector<RecordingChunk> chunks_of(const std::filesystem::path& recording) {
    RecordingReader reader(recording);
    std::vector<RecordingChunk> chunks;
    while (auto chunk = reader.next()) chunks.push_back(std::move(*chunk));
    return chunks;
}

void write_recording(const std::vector<RecordingChunk>& chunks, const std::filesystem::path& file) {
    std::ofstream out(file, std::ios::binary);
    out << recording_header();
    for (std::size_t i = 0; i < chunks.size(); ++i) out << chunk_bytes(chunks[i], i);
}

std::string missing_of(const std::vector<RecordingChunk>& chunks, const std::vector<std::string>& must_hold) {
    const auto held = [&](const std::string& part) {
        return std::ranges::any_of(chunks, [&](const RecordingChunk& chunk) {
            return chunk.type == chunk_types::kEvent && chunk.payload.find(part) != std::string::npos;
        });
    };
    const auto missing = std::ranges::find_if_not(must_hold, held);
    return missing == must_hold.end() ? std::string() : *missing;
}

std::optional<Tampered> tamper(std::vector<RecordingChunk>& chunks) {
    if (auto pose = tamper_pose(chunks)) return pose;
    if (const auto matches = events_that_begin(chunks, R"({"what":"matched")"); !matches.empty()) {
        Json event = Json::parse(chunks[matches.front()].payload);
        if (!move_by_one_bit(event["patient_from_ct"])) return std::nullopt;
        chunks[matches.front()].payload = event.dump();
        return Tampered{0, {}, "patient_from_ct.11"};
    }
    const auto refusals = events_that_begin(chunks, R"({"what":"refused")");
    if (refusals.empty()) return std::nullopt;
    std::string& text = chunks[refusals.front()].payload;
    const std::size_t digit = text.find_first_of("0123456789");
    if (digit == std::string::npos) return std::nullopt;
    text[digit] = text[digit] == '1' ? '2' : '1';
    return Tampered{0, {}, "why"};
}

}  // namespace planlight::test
