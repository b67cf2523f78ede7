#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "app/recording/anonymous.h"
#include "app/recording/frame_choice.h"
#include "app/recording/recorded_inputs.h"
#include "app/session_observer.h"
#include "planning_io/recording/recording_writer.h"

namespace planlight {

/// How much of a session is recorded.
enum class RecordMode {
    none,
    events,  ///< all that happened, and as many frames as a gigabyte an hour holds: round presses, faults and what the
             ///< gate says, and now and then
    all,     ///< every frame as well: what `replay` needs
};

/// What a recording says of itself first.
struct RecordingHead {
    RecordMode mode = RecordMode::events;
    bool anonymous = false;  ///< frames blurred outside of the plan's region, no names, no match to go on with
    std::string program, program_hash;  ///< version; XXH3-128 of its file
    std::string case_code, case_title, volume_hash, mesh_hash, plan_hash, plan_name, plan_version;
    std::filesystem::path case_folder;  ///< where it was then
    Eigen::Vector3d up_in_ct{0, 0, 1};  ///< of the drawing's labels
    std::vector<std::string> card;      ///< as it was lit (`DrawingSettings::card`)
    std::string began_utc, operator_name, computer;
    bool operator_named = false;  ///< by an option or the site; else the name is that of the account
    std::string settings;         ///< what the session was told to do: an object of JSON; empty: not told
};

/// The head without what names a person or a place.
RecordingHead without_names(RecordingHead head);

/// Of this program, this case, this user, now.
RecordingHead recording_head(const Case& the_case, const std::filesystem::path& case_folder, RecordMode mode,
                             const DrawingSettings& drawing);

/// Keeps what a session does in a recording, without ever delaying it.
class SessionRecorder final : public SessionObserver {
public:
    SessionRecorder(std::unique_ptr<RecordingSink> sink, const RecordingHead& head,
                    const RecordingWriterSettings& writing = {}, const FrameChoiceSettings& choice = {},
                    std::optional<NamesLeftOut> anonymous = {});
    ~SessionRecorder() override;  ///< as `finish` does

    RecordingState state() const { return writer_.state(); }
    bool room_was_entered() const { return room_entered_; }
    /// What a person must hear of it now, one sentence that names no file: the disk is full or too slow; empty while
    /// all is well.
    std::string trouble() const;
    /// Ends the recording. What is missing in it, or may be, in one sentence; empty when all of it is on the disk.
    std::string finish();

    void room_entered(const RoomFacts& room) noexcept override;
    void pressed(const std::string& action) noexcept override;
    void said(const std::string& kind, const std::string& headline,
              const std::vector<std::string>& details) noexcept override;
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override;
    void clock_read(Instant now) noexcept override;
    void frame_exposed() noexcept override;
    void frame_taken(const StereoFrame& frame) noexcept override;
    void picture_shown(const RgbImage& picture, Instant valid_until, Instant lit_from) noexcept override;
    void went_dark() noexcept override;
    void cameras_doubted(const std::string& doubt) noexcept override;
    void device_failed(const Error& fault) noexcept override;
    void stopped(const Error& why) noexcept override;
    void scanned(const Session& session) noexcept override;
    void matched(const Session& session) noexcept override;
    void updated(const Session& session, const Session::Update& update) noexcept override;
    void skin_checked(const SkinCheck& check) noexcept override;
    void match_offered(const KeptMatch& match) noexcept override;
    void resumed(const Session& session, const ResumeCheck& check) noexcept override;
    void refused(SessionCall call, const std::exception& why) noexcept override;
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override;

private:
    struct Frame {
        std::shared_ptr<const StereoFrame> pictures;
        PlanRegion region;  ///< of an anonymous recording: what stays sharp
    };
    struct PackedSize;
    void input(RecordedInput input);
    void flush();
    void add(const ChunkType& type, std::string text);
    void keep(const KeptMatch& match);
    template <class MakeText>
    void event(const MakeText& make_text) noexcept;
    static StereoFrame blurred(const Frame& frame);
    void write(const Frame& frame);
    void name_items(const Session& session) noexcept;
    void choose(const Frame& frame);
    /// A press, a fault, a refusal, another word of the gate: the frames round it are kept.
    void something_happened() noexcept;
    void keep_picture(const RgbImage& picture);

    RecordMode mode_;
    std::mutex mutex_;
    std::vector<RecordedInput> inputs_;  ///< since the last event
    Instant now_{}, pictured_{};
    FrameChoice choice_;
    std::size_t most_before_;
    std::deque<Frame> before_;                  ///< the last frames that were not kept
    std::shared_ptr<PackedSize> packed_, lit_;  ///< of the last frame, and of the last light, that were packed
    bool scanning_ = false, first_of_scan_ = false;
    bool kept_frame_ = false;  ///< the last one
    std::atomic<bool> room_entered_{false};
    std::string happening_;  ///< what the light was last; another is an event
    std::string said_;
    std::optional<NamesLeftOut> anonymous_;
    PlanRegion region_;  ///< by the last pose
    RecordingWriter writer_;
};

}  // namespace planlight
