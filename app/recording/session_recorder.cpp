#include "app/recording/session_recorder.h"

#include <fmt/format.h>

#include <atomic>

#include "app/console.h"
#include "app/recording/recording_head.h"
#include "app/recording/session_events.h"
#include "planning_io/recording/packed_pictures.h"

namespace planlight {

using Kind = RecordedInput::Kind;

namespace {

constexpr double kFramesPack = 0.35, kLightPacks = 0.02;    // about, until the first is packed
constexpr Instant kPictureEvery = std::chrono::seconds(2);  // where every frame is kept: it can be made again

std::size_t bytes_of(const StereoFrame& frame) {
    return frame.left.pixels.size() + frame.right.pixels.size();
}

}  // namespace

/// How well pictures of this room pack, as the writer's thread last found it.
struct SessionRecorder::PackedSize {
    explicit PackedSize(double guess) : share(guess) {}
    std::atomic<double> share;
    std::string found(std::string packed, std::size_t raw) {
        if (raw > 0) share = static_cast<double>(packed.size()) / static_cast<double>(raw);
        return packed;
    }
};

SessionRecorder::SessionRecorder(std::unique_ptr<RecordingSink> sink, const RecordingHead& head,
                                 const RecordingWriterSettings& writing, const FrameChoiceSettings& choice,
                                 std::optional<NamesLeftOut> anonymous)
    : mode_(head.mode),
      choice_(choice),
      most_before_(choice.before),
      packed_(std::make_shared<PackedSize>(kFramesPack)),
      lit_(std::make_shared<PackedSize>(kLightPacks)),
      anonymous_(std::move(anonymous)),
      writer_(std::move(sink), writing) {
    writer_.add({chunk_types::kHead, Instant{}, text_of(head)});
}

SessionRecorder::~SessionRecorder() {
    try {
        finish();
    } catch (const std::exception&) {  // no memory: it ends without its last word
    }
}

std::string SessionRecorder::finish() {
    const std::lock_guard lock(mutex_);
    flush();
    const RecordingState state = writer_.finish(now_);
    std::string text;
    if (state.dropped_chunks > 0)
        text = fmt::format("{} pieces of the recording are missing: {}.", state.dropped_chunks,
                           state.problem.empty() ? "the disk was too slow" : state.problem.whole);
    if (!state.sync_problem.empty())
        text += fmt::format("{}The disk did not confirm the recording: {}. Look whether it can be read.",
                            text.empty() ? "" : " ", state.sync_problem.whole);
    return text;
}

std::string SessionRecorder::trouble() const {
    const RecordingState state = writer_.state();
    if (!state.problem.empty())
        return state.dropped_chunks == 0
                   ? fmt::format("The recording stands still: {}; the light is not affected.",
                                 state.problem.in_few_words)
                   : fmt::format("The recording stands still: {}. {} pieces are missing; the light is not affected.",
                                 state.problem.in_few_words, state.dropped_chunks);
    if (!state.sync_problem.empty())
        return fmt::format("The disk did not confirm the recording: {}; the light is not affected.",
                           state.sync_problem.in_few_words);
    if (state.dropped_chunks > 0)
        return fmt::format("The disk is too slow for the recording: {} pieces are missing; the light is not affected.",
                           state.dropped_chunks);
    return {};
}

void SessionRecorder::input(RecordedInput input) {
    if (anonymous_ && (input.kind == Kind::failed || input.kind == Kind::stopped || input.kind == Kind::doubt)) {
        input.text = anonymous_->text_without(std::move(input.text));
        input.remedy = anonymous_->text_without(std::move(input.remedy));
    }
    inputs_.push_back(std::move(input));
}

/// What the devices answered stands before what came of it.
void SessionRecorder::flush() {
    if (inputs_.empty()) return;
    add(chunk_types::kInputs, packed(inputs_));
    inputs_.clear();
}

/// What is no picture is always kept, at the cost of the frames.
void SessionRecorder::add(const ChunkType& type, std::string text) {
    choice_.written(static_cast<double>(text.size() + kChunkHeaderBytes));
    writer_.add({type, now_, std::move(text)});
}

/// A recording that fails (no memory) must not take the session with it.
template <class MakeText>
void SessionRecorder::event(const MakeText& make_text) noexcept {
    try {
        std::string text = make_text();
        const std::lock_guard lock(mutex_);
        if (anonymous_) text = anonymous_->out_of(text);
        flush();
        add(chunk_types::kEvent, std::move(text));
    } catch (const std::exception&) {
    }
}

void SessionRecorder::room_entered(const RoomFacts& room) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        now_ = room.now;
        room_entered_ = true;
        std::string text = session_events::room(room);
        if (anonymous_) text = anonymous_->out_of_room(text);
        add(chunk_types::kRoom, std::move(text));
    } catch (const std::exception&) {
    }
}

void SessionRecorder::pressed(const std::string& action) noexcept {
    event([&] { return session_events::pressed(action); });
    something_happened();
}

void SessionRecorder::said(const std::string& kind, const std::string& headline,
                           const std::vector<std::string>& details) noexcept {
    try {
        const std::string now = kind + headline;
        {
            const std::lock_guard lock(mutex_);
            if (now == said_) return;
            said_ = now;
        }
        event([&] { return session_events::said(kind, headline, details); });
    } catch (const std::exception&) {
    }
}

void SessionRecorder::asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept {
    event([&] { return session_events::asked(call, landmarks, which); });
    const std::lock_guard lock(mutex_);
    // The head may lie elsewhere by now: what of it may be shown is known with the next pose.
    if (call != SessionCall::update && call != SessionCall::light_landmark && call != SessionCall::light_item)
        region_ = {};
    scanning_ = first_of_scan_ =
        call == SessionCall::scan || call == SessionCall::check_skin || call == SessionCall::resume;
}

void SessionRecorder::clock_read(Instant now) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        now_ = now;
        input({Kind::clock, now, {}, 0, {}, {}});
    } catch (const std::exception&) {
    }
}

void SessionRecorder::frame_exposed() noexcept {
    try {
        const std::lock_guard lock(mutex_);
        input({Kind::exposed, {}, {}, 0, {}, {}});
    } catch (const std::exception&) {
    }
}

void SessionRecorder::frame_taken(const StereoFrame& frame) noexcept {
    try {
        const std::string hash = hash_of(frame);
        const auto pictures = std::make_shared<const StereoFrame>(frame);
        const std::lock_guard lock(mutex_);
        const Frame kept{pictures, region_};
        now_ = std::max(now_, frame.at);
        kept_frame_ = false;
        if (mode_ == RecordMode::all)
            write(kept);
        else
            choose(kept);
        input({Kind::frame, frame.at, frame.exposure, frame.number, hash, {}});
        if (scanning_) flush();
    } catch (const std::exception&) {
    }
}

StereoFrame SessionRecorder::blurred(const Frame& frame) {
    StereoFrame blurred = *frame.pictures;
    blurred.left = blurred_outside(blurred.left, frame.region.left);
    blurred.right = blurred_outside(blurred.right, frame.region.right);
    return blurred;
}

void SessionRecorder::write(const Frame& frame) {
    const auto pack = [frame, packed = packed_, anonymous = anonymous_.has_value()] {
        return packed->found(anonymous ? pack_frame(blurred(frame)) : pack_frame(*frame.pictures),
                             bytes_of(*frame.pictures));
    };
    kept_frame_ = writer_.add_picture(chunk_types::kFrame, frame.pictures->at,
                                      bytes_of(*frame.pictures) + kChunkHeaderBytes, pack);
}

/// Of a scan the first picture alone, under white light: the stripes tell nothing that the cloud does not.
void SessionRecorder::choose(const Frame& frame) {
    const double bytes = packed_->share * static_cast<double>(bytes_of(*frame.pictures));
    if (scanning_) {
        if (first_of_scan_) choice_.written(bytes), write(frame);
        first_of_scan_ = false;
        return;
    }
    if (choice_.keep(frame.pictures->at, bytes)) {
        write(frame);
        return;
    }
    before_.push_back(frame);
    if (before_.size() > most_before_) before_.pop_front();
}

void SessionRecorder::something_happened() noexcept {
    try {
        const std::lock_guard lock(mutex_);
        if (mode_ == RecordMode::all) return;
        const double bytes =
            before_.empty() ? 0 : packed_->share * static_cast<double>(bytes_of(*before_.back().pictures));
        const std::size_t kept = choice_.event(before_.size(), bytes);
        for (std::size_t i = before_.size() - kept; i < before_.size(); ++i) write(before_[i]);
        before_.clear();
    } catch (const std::exception&) {
    }
}

void SessionRecorder::picture_shown(const RgbImage& picture, Instant valid_until, Instant lit_from) noexcept {
    try {
        std::string hash = hash_of(picture);
        const std::lock_guard lock(mutex_);
        input({Kind::shown, lit_from, valid_until, 0, std::move(hash), {}});
        if (anonymous_) return;  // the names of the plan's items stand in it
        if (!scanning_ && kept_frame_ && (mode_ == RecordMode::events || now_ - pictured_ > kPictureEvery))
            keep_picture(picture);
    } catch (const std::exception&) {
    }
}

/// Thin lines on black pack to next to nothing.
void SessionRecorder::keep_picture(const RgbImage& picture) {
    pictured_ = now_;
    const auto kept = std::make_shared<const RgbImage>(picture);
    const std::size_t raw = 3 * picture.pixels.size();
    choice_.written(lit_->share * static_cast<double>(raw));
    writer_.add_picture(chunk_types::kPicture, now_, raw,
                        [kept, raw, lit = lit_] { return lit->found(pack_picture(*kept), raw); });
}

void SessionRecorder::went_dark() noexcept {
    try {
        const std::lock_guard lock(mutex_);
        input({Kind::dark, {}, {}, 0, {}, {}});
    } catch (const std::exception&) {
    }
}

void SessionRecorder::cameras_doubted(const std::string& doubt) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        input({Kind::doubt, {}, {}, 0, doubt, {}});
    } catch (const std::exception&) {
    }
}

void SessionRecorder::device_failed(const Error& fault) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        input({Kind::failed, {}, {}, 0, fault.what(), fault.remedy});
    } catch (const std::exception&) {
    }
    something_happened();
}

void SessionRecorder::stopped(const Error& why) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        input({Kind::stopped, {}, {}, 0, why.what(), why.remedy});
    } catch (const std::exception&) {
    }
}

void SessionRecorder::scanned(const Session& session) noexcept {
    event([&] { return session_events::scanned(session); });
}

void SessionRecorder::matched(const Session& session) noexcept {
    name_items(session);
    event([&] { return session_events::matched(session); });
    try {
        if (auto match = session.kept_match()) {
            match->made_utc = today();
            keep(*match);
        }
    } catch (const std::exception&) {
    }
}

/// Of an anonymous recording: items have numbers, and of the face nothing is known until the next pose.
void SessionRecorder::name_items(const Session& session) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        region_ = {};
        if (anonymous_) anonymous_->add_items(session.drawing());
    } catch (const std::exception&) {  // as in `event`
    }
}

/// All that it takes to go on with this match after whatever ends this session.
void SessionRecorder::keep(const KeptMatch& match) {
    if (anonymous_) return;  // the skin as it was found is in it
    std::string text = text_of(match);
    const std::lock_guard lock(mutex_);
    flush();
    add(chunk_types::kMatch, std::move(text));
}

void SessionRecorder::match_offered(const KeptMatch& match) noexcept {
    try {
        keep(match);
    } catch (const std::exception&) {
    }
}

void SessionRecorder::resumed(const Session& session, const ResumeCheck& check) noexcept {
    name_items(session);
    event([&] { return session_events::resumed(session, check); });
}

void SessionRecorder::updated(const Session& session, const Session::Update& update) noexcept {
    event([&] { return session_events::updated(session, update); });
    if (!anonymous_) return;
    try {
        PlanRegion region = plan_region(session, update.pose);
        const std::lock_guard lock(mutex_);
        region_ = std::move(region);
    } catch (const std::exception&) {
    }
}

void SessionRecorder::skin_checked(const SkinCheck& check) noexcept {
    event([&] { return session_events::skin_checked(check); });
}

void SessionRecorder::refused(SessionCall call, const std::exception& why) noexcept {
    event([&] { return session_events::refused(call, why); });
    something_happened();
}

void SessionRecorder::gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept {
    event([&] { return session_events::gate(call, at, off_mm, ruling); });
    if (!ruling) return;
    bool changed = false;
    try {
        std::string now = session_events::word_of(ruling->trust) + ruling->headline;
        const std::lock_guard lock(mutex_);
        changed = now != happening_;
        happening_ = std::move(now);
    } catch (const std::exception&) {
    }
    if (changed) something_happened();
}

}  // namespace planlight
