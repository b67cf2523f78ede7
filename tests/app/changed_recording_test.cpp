// Recordings whose bytes are whole and whose words are not, as another program may write them: each is shown as far as
// it goes, or refused by name.
#include <limits>
#include <random>

#include "app/export/match_that_stood.h"
#include "app/kept_match.h"
#include "app/recording/recorded_inputs.h"
#include "app/recording/replay_session.h"
#include "app/recording/resume_offer.h"
#include "app/report/operation_pdf.h"
#include "app/report/recorded_moments.h"
#include "app/report/recording_review.h"
#include "planning_io/types/error.h"
#include "tests/app/recording_by_hand.h"

namespace planlight {
namespace {

json rigid() {
    return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

/// As the recorder writes it: what an event is stands first, and hours of them are told apart by it.
std::string as_recorded(const json& event) {
    if (!event.is_object()) return event.dump();
    nlohmann::ordered_json ordered = nlohmann::ordered_json::object();
    for (const char* first : {"what", "call"})
        if (event.contains(first)) ordered[first] = event[first];
    for (const auto& [name, value] : event.items()) ordered[name] = value;
    return ordered.dump();
}

/// One of each that a session's recording holds.
class ChangedRecording : public RecordingByHand {
protected:
    ChangedRecording() {
        match();
        KeptMatch kept;
        kept.registration.verdict = Verdict::yes;
        kept.made_utc = "2026-03-14T09:31:00Z";
        kept.markers.resize(3);
        add(chunk_types::kMatch, text_of(kept));
        lit(0.1, 0.2, "aligned");
        followed();
        skin_check(0.4);
        dark("too few markers");
        event({{"what", "asked"}, {"call", "hide_item"}, {"which", 0}});
        event({{"what", "asked"}, {"call", "light_landmark"}, {"which", 1}});
        event({{"what", "refused"}, {"call", "scan"}, {"why", "it is too dark"}});
        event({{"what", "pressed"}, {"action", "confirm"}, {"utc", "2026-03-14T09:32:00Z"}});
        event({{"what", "said"}, {"kind", "dark"}, {"headline", "DARK"}, {"details", {"a", "b"}}});
        event({{"what", "gate"}, {"call", "verify"}, {"at_ns", 5}, {"utc", "2026-03-14T09:32:00Z"}});
        event({{"what", "resumed"},
               {"verdict", "yes"},
               {"markers", 4},
               {"skin_off_mm", 0.3},
               {"items", {"Line", "Hole"}},
               {"predicted_mm", {0.5, 0.6}},
               {"risk",
                {json::array({{{"structure", "nerve"}, {"distance_mm", 3.5}, {"through", false}}}), json::array()}}});
        add(chunk_types::kLost, R"({"chunks": 2, "bytes": 100})");
        add(chunk_types::kDone, R"({"dropped_chunks": 2, "dropped_bytes": 100})");
        for (RecordingChunk& chunk : chunks_)
            if (chunk.type == chunk_types::kEvent) chunk.payload = as_recorded(json::parse(chunk.payload));
    }

    /// A frame that was kept, its light, what the devices answered, and all that an update tells.
    void followed() {
        ++step_;
        const Instant at = kOrigin + kStep * step_;
        const StereoFrame frame{GrayImage(32, 24, 90), GrayImage(32, 24, 80), at, {}, 7};
        add(chunk_types::kFrame, pack_frame(frame));
        add(chunk_types::kPicture, pack_picture(RgbImage(16, 12, {0, 255, 0})));
        RecordedInput failed;
        failed.kind = RecordedInput::Kind::failed, failed.text = "Left camera: gone", failed.remedy = "Look.";
        add(chunk_types::kInputs, packed({failed}));
        event({{"what", "updated"},
               {"number", 7},
               {"at_ns", at.count()},
               {"exposure_ns", 5},
               {"pose", {{"rig_from_patient", rigid()}, {"markers", {4, 4}}, {"bound_95_mm", 0.3}}},
               {"light", {{"lit", true}, {"lit_from_ns", at.count()}, {"rig_from_ct", rigid()}}},
               {"check", {{"items", {{true, 4, 4, 0.1, 0.1}, {true, 2, 2, 0.2, 0.1}}}, {"seen", 6}, {"off_mm", 0.2}}},
               {"causes", {{{"fault", "partly_covered"}, {"size", 0.3}}}}});
        event({{"what", "gate"},
               {"call", "step"},
               {"at_ns", at.count()},
               {"trust", "aligned"},
               {"headline", "ALIGNED"},
               {"off_mm", 0.2}});
    }

    void write(const std::vector<RecordingChunk>& chunks) const {
        std::ofstream out(file(), std::ios::binary);
        out << recording_header();
        for (std::size_t i = 0; i < chunks.size(); ++i) out << chunk_bytes(chunks[i], i);
    }

    /// Everything that looks at a recording without the case it is of; each refuses with a sentence or is content.
    void look_at_it() const {
        const auto refused_or_done = [](const char* who, const auto& look) {
            try {
                look();
            } catch (const Error& refusal) {
                EXPECT_FALSE(refusal.remedy.empty()) << who;
                EXPECT_TRUE(refusal.exit_code == ExitCode::file_damaged || refusal.exit_code == ExitCode::input_refused)
                    << who << ": " << refusal.what();
            } catch (const std::exception& fault) {
                ADD_FAILURE() << who << " calls it a fault of the program: " << fault.what();
            }
        };
        refused_or_done("review", [&] {
            const RecordingTimeLine line = time_line_of(file());
            review_page(line, {});
            review_json(line);
            RecordedMoments moments(file(), line);
            for (std::size_t i = 0; i < line.frames_s.size(); ++i)
                moments.moment(i), moments.rig_from_patient(i), moments.match(i);
        });
        refused_or_done("report", [&] {
            const OperationFacts f = facts_of_operation(file());
            operation_json(f);
            operation_pdf(f, PaperSize::a4);
            page_of(f);
        });
        refused_or_done("resume", [&] { last_match_of(file()); });
        refused_or_done("export", [&] { match_that_stood(file()); });
        refused_or_done("replay", [&] { head_of_recording(file()); });
    }
};

/// One value of the JSON is another: of another kind, or beyond all measure; or it is gone. Says which; empty: it is no
/// JSON.
std::string change(std::string& payload, std::mt19937& random) {
    const json whole = json::parse(payload, nullptr, false);
    if (!whole.is_structured() || whole.empty()) return {};
    static const std::vector<json> kOthers{nullptr,
                                           true,
                                           -1,
                                           0.5,
                                           1e308,
                                           -1e308,
                                           std::numeric_limits<std::int64_t>::max(),
                                           std::numeric_limits<std::int64_t>::min(),
                                           "",
                                           "yes",
                                           json::array(),
                                           json::object(),
                                           {{1}}};
    std::vector<json::json_pointer> places;
    const json flat = whole.flatten();
    for (const auto& [place, value] : flat.items()) {
        for (json::json_pointer at(place); !at.empty(); at = at.parent_pointer()) places.push_back(at);
    }
    const json::json_pointer at = places[random() % places.size()];
    json changed = whole;
    const std::size_t other = random() % (kOthers.size() + 1);
    if (other < kOthers.size())
        changed[at] = kOthers[other];
    else if (changed[at.parent_pointer()].is_object())
        changed[at.parent_pointer()].erase(at.back());
    else
        changed[at.parent_pointer()].erase(static_cast<std::size_t>(std::stoul(at.back())));
    payload = as_recorded(changed);
    return at.to_string();
}

TEST_F(ChangedRecording, AsItWasIsShownToItsEnd) {
    write(chunks_);
    const RecordingTimeLine line = time_line_of(file());
    EXPECT_EQ(line.ended, "");
    EXPECT_FALSE(line.stretches.empty());
    ASSERT_EQ(line.places.size(), 1u);
    EXPECT_NE(line.places[0].updated, 0u);
    EXPECT_NE(line.places[0].light, 0u);
    EXPECT_NE(line.places[0].match, 0u);
    EXPECT_TRUE(facts_of_operation(file()).moment.has_value());
    EXPECT_TRUE(last_match_of(file()).match.has_value()) << last_match_of(file()).why_none;
    look_at_it();
}

TEST_F(ChangedRecording, AValueOfAnotherKindIsNeverAFaultOfOurs) {
    for (unsigned seed = 0; seed < 1500 && !HasFailure(); ++seed) {
        std::mt19937 random(seed);
        auto chunks = chunks_;
        RecordingChunk& chunk = chunks[random() % chunks.size()];
        const std::string place = change(chunk.payload, random);
        if (place.empty()) continue;
        SCOPED_TRACE("seed " + std::to_string(seed) + ", " + place + ": " + chunk.payload.substr(0, 300));
        write(chunks);
        look_at_it();
    }
}

TEST_F(ChangedRecording, NorIsAByteOfAnyPayloadOrAPieceThatIsGoneOrThereTwice) {
    for (unsigned seed = 0; seed < 400 && !HasFailure(); ++seed) {
        std::mt19937 random(seed);
        auto chunks = chunks_;
        const std::size_t which = random() % chunks.size();
        std::string& payload = chunks[which].payload;
        SCOPED_TRACE("seed " + std::to_string(seed) + ", chunk " + std::to_string(which));
        switch (random() % 4) {
            case 0:
                chunks.erase(chunks.begin() + static_cast<long>(which));
                break;
            case 1:
                chunks.insert(chunks.begin() + static_cast<long>(random() % chunks.size()), chunks[which]);
                break;
            case 2:
                payload.resize(random() % (payload.size() + 1));
                break;
            default:
                for (int i = 0; i < 3; ++i) payload[random() % payload.size()] = static_cast<char>(random());
        }
        write(chunks);
        look_at_it();
    }
}

/// As a disk or a line spoils it: no checksum is right any more.
TEST_F(ChangedRecording, NorIsAByteOfTheFileOrAnEndThatIsMissing) {
    write(chunks_);
    std::ifstream in(file(), std::ios::binary);
    const std::string whole(std::istreambuf_iterator<char>(in), {});
    for (unsigned seed = 0; seed < 300 && !HasFailure(); ++seed) {
        std::mt19937 random(seed);
        std::string bytes = whole;
        const std::size_t at = random() % bytes.size();
        if (seed % 2 == 0)
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
        else
            bytes.resize(at);
        SCOPED_TRACE("seed " + std::to_string(seed) + ", byte " + std::to_string(at));
        std::ofstream(file(), std::ios::binary) << bytes;
        look_at_it();
    }
}

}  // namespace
}  // namespace planlight
