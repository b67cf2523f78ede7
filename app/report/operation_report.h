#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/recording/session_recorder.h"
#include "app/report/html_page.h"
#include "app/room_kind.h"
#include "planning_io/recording/recording_reader.h"
#include "projection/clearance.h"

namespace planlight {

/// Of the plan, as a recording tells it. Times are seconds since the room was entered.
struct OperationItem {
    std::string name;                              ///< not always another's: the plan may have two of a name
    std::vector<std::pair<double, double>> shown;  ///< from when to when there was light of it, as CHECK told
    double shown_s = 0;
    std::optional<double>
        predicted_mm;                 ///< within this in 95 % of cases, by the last match that was used; or not known
    std::vector<double> measured_mm;  ///< by CHECK, each time that its light was seen
    bool looked_at = false;           ///< CHECK told at least once whether the light reached it
    Clearances risk = {};             ///< to the plan's risk structures, as planned; what is worst first
    std::string code = {};  ///< "#C": what the light had in place of the name, by the last match; empty: the name
};

/// "#C  Burr hole left", as the window has it.
std::string named(const OperationItem& item);

struct OperationMatch {
    double at_s = 0;
    std::string utc, verdict;  ///< "yes", "ask", "no"
    std::vector<std::string> reasons;
    std::optional<double> residual_rms_mm;
    std::size_t points = 0;
};

/// Something that a person said or did, or that went wrong.
struct OperationEvent {
    double at_s = 0;
    std::string utc, what;
    bool grave = false;  ///< the light was stopped, or the skin does not lie where it should: told before all others
};

/// A moment with its pictures.
struct OperationMoment {
    double at_s = 0;
    std::string trust;  ///< "dark", "look", "aligned"
    GrayImage left, right;
    RgbImage light;
    std::array<RgbImage, 2> compared{};  ///< both pictures with how far off the light is (`compare_moment`); or empty
    std::string compared_words{};        ///< what was found, or why nothing was compared; empty: nobody tried
};

/// What a recording tells of an operation.
struct OperationFacts {
    RecordingHead head;
    std::string recording_hash, file;
    bool room_entered = false;
    RoomKind room_kind = RoomKind::real;
    std::string room, rig_hash, rig_made_on;
    std::string room_entered_utc;  ///< what 0:00:00 of the room clock was; empty: not told
    std::vector<std::string> serials;
    double lasted_s = 0;
    double lit_s = 0, aligned_s = 0, look_s = 0;  ///< light of the plan; that of a single landmark does not count
    std::vector<OperationMatch> matches;
    std::vector<OperationEvent> said;      ///< confirmations, checks of the skin, DARK, stops: in order
    std::vector<OperationEvent> refusals;  ///< of a scan, a match, a check; devices that failed
    std::vector<OperationItem> items;
    std::map<std::string, std::pair<int, double>> dark;  ///< while following: reason, how often, for how many seconds
    /// Every half second of light at most: when, whether it was aligned, and the largest of `light_off_mm` since the
    /// last; -1 where it was not measured.
    struct Sample {
        double at_s = 0;
        bool aligned = false;
        double off_mm = -1;
    };
    std::vector<Sample> course;
    std::optional<double> skin_off_mm;  ///< of the checks of the skin the worst; empty: none gave an answer
    std::vector<double> light_off_mm;   ///< of all of the light (95 % of it lies within), each measurement
    std::optional<OperationMoment> moment;
    int updates = 0, verified = 0, stops = 0;
    int projector_lost = 0;       ///< times
    int verified_by_program = 0;  ///< of `verified`: without anybody's press (`--autoplay`)
    std::uint64_t chunks = 0, bytes = 0, kept_frames = 0;
    std::uint64_t lost_chunks = 0;  ///< that the disk did not take, by LOST and by the recording's last word
    std::string ended;              ///< how the recording ends, in words; empty: it is whole
    bool damaged = false;
};

/// Reads the recording from its beginning to its end. Throws InputError, DamagedFileError, and what `go_on` throws,
/// which is called again and again meanwhile and may be empty.
OperationFacts facts_of_operation(const std::filesystem::path& recording, const std::function<void()>& go_on = {});

/// Above these the light is not trusted, and goes out, as the light gate has them.
inline constexpr double kOperationLook_mm = 1, kOperationStop_mm = 2;

/// "3 min 12 s", "12.4 s".
std::string duration_text(double s);
/// Of the room's clock: "0:03:12".
std::string clock_text(double s);

/// By which limits the light was judged, and how late it was held to be; empty: the recording does not tell.
std::string settings_in_words(const RecordingHead& head);

/// Who operated, or under which account the program ran; empty where it was left out.
std::string operator_text(const RecordingHead& head);

/// When an item was shown, first to last, or why nothing is known of it.
std::string shown_text(const OperationItem& item, const OperationFacts& facts);

/// The plan held risk structures.
bool any_risk(const OperationFacts& facts);

/// A figure beyond what the gate lets pass is marked by a sign, not by its colour alone: empty, "⚠", "✗".
std::string sign_of(double value_mm);

/// What measured and predicted mean, and what neither can see: stands under the table of the items.
inline constexpr const char* kWhatCirclesSay =
    "Blue: the plan, where it belongs on the skin. Circles: its light, green within 1 mm, amber within 2 mm, red "
    "beyond; "
    "grey: none was found there. ";
inline constexpr const char* kWhatIsMeasured =
    "Predicted: within this in 95 of 100 cases, by the last match. Measured: where the cameras saw half of an item's "
    "light or "
    "more, against where it belongs on the skin as the scan found it, mm. What cameras, CT and markers share is not "
    "seen by either: "
    "skin that slid over the bone, markers that moved all together.";

/// How far off the light of all items was, each time that it was seen, in the terms of ASTM F2554.
struct Deviations {
    std::size_t count = 0;
    double mean_mm = 0, deviation_mm = 0, rms_mm = 0, worst_mm = 0;
};
Deviations deviations_of(const OperationFacts& facts);
/// As a sentence that also says what of that practice was not done; empty where nothing was measured.
std::string in_terms_of_f2554(const OperationFacts& facts);

/// The verdict of a page, first of all that stands on it.
struct OperationVerdict {
    enum class Kind { good, look, stop } kind = Kind::look;
    std::string sentence;
    std::vector<std::string> reasons;
};
OperationVerdict verdict_of(const OperationFacts& facts);
/// The same, as pages have theirs.
PageVerdict page_verdict(const OperationFacts& facts);
/// "✓", "⚠", "✗"; and "good", "look", "stop".
std::string sign_of(OperationVerdict::Kind kind);
std::string word_of(OperationVerdict::Kind kind);

/// By how far off they were (95 %), the farthest first. Those that were shown and never seen stand behind what was off
/// by more than the gate lets pass; those that are as far off as each other, and those without light, as in the plan.
std::vector<const OperationItem*> worst_first(const std::vector<OperationItem>& items);

/// All figures of the page, and those for which it has no room.
std::string operation_json(const OperationFacts& facts);

/// The page of two sheets, and `json` beside it (.json); both readable by their owner only.
void write_operation_report(const OperationFacts& facts, const std::string& json, const std::filesystem::path& file);

}  // namespace planlight
