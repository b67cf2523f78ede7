#include "app/live/live_session.h"

#include <array>

#include "app/case_model.h"
#include "planning_io/types/error.h"
#include "planning_io/types/steady_clock.h"

namespace planlight {
namespace {

// For an observer, in the order of their enumerations.
constexpr std::array kActions{"none",    "scan",          "register",   "track",      "stop",      "dark",     "quit",
                              "confirm", "use landmarks", "check skin", "light item", "hide item", "show item"};
constexpr std::array kStatusKinds{"ready", "scanning", "matching", "aligned", "check", "refused", "dark", "waiting"};

}  // namespace

LiveSession::LiveSession(MakeRoom make_room, const Case& the_case, const CaseDrawing& drawing,
                         std::filesystem::path keep_matches_in, SessionObserver* observer,
                         std::optional<ResumeOffer> offer, const SkinCheckScheduleSettings& checks)
    : case_(the_case),
      drawing_(drawing),
      keep_matches_in_(std::move(keep_matches_in)),
      observer_(observer),
      blank_(model_of_case(the_case, drawing)),
      model_(blank_),
      gate_(observer),
      checks_(checks),
      offer_(std::move(offer)) {
    enter(state_, blank_, model_, scan_there_);
    said();
    show_alive();
    thread_ = std::thread([this, make_room = std::move(make_room)] {
        try {
            run(make_room);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            fault_ = std::current_exception();
            light_ = {nullptr, light_.number + 1};
        }
        projecting_ = false;
    });
}

LiveSession::~LiveSession() {
    end();
    thread_.join();
}

void LiveSession::end() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        ++darks_;  // a scan that runs ends at its next picture
        light_ = {nullptr, light_.number + 1};
    }
    wake_.notify_all();
}

NotKept LiveSession::not_kept() const {
    const std::lock_guard lock(mutex_);
    return not_kept_;
}

/// Under the lock: why the press does nothing now; empty: it is taken.
std::string LiveSession::refused_press(OperatorAction action) const {
    if (const std::string why = why_not(state_, action, scan_there_);
        !why.empty() && action != OperatorAction::stop && action != OperatorAction::dark)
        return why;
    if (action == OperatorAction::confirm && !model_.confirm) return why_not(SessionState::ready, action);
    return {};
}

bool LiveSession::is_of_items(OperatorAction action) {
    return action == OperatorAction::light_item || action == OperatorAction::hide_item ||
           action == OperatorAction::show_item;
}

/// Under the lock: where the session stands once the presses that wait are given up.
SessionState LiveSession::without_waiting() const {
    for (const Press& press : presses_) {
        const bool matches =
            press.action == OperatorAction::do_register || press.action == OperatorAction::use_landmarks;
        if (matches && state_ == SessionState::matching) return after(state_, SessionHappening::failed);
        if (press.action == OperatorAction::confirm && press.from == SessionState::unsure) return SessionState::unsure;
    }
    return state_;
}

std::string LiveSession::post(OperatorAction action, AskedBy by, std::optional<std::size_t> item,
                              std::optional<std::uint64_t> darks) {
    if (action == OperatorAction::none) return {};
    {
        const std::lock_guard lock(mutex_);
        if (darks && *darks != darks_) return "DARK was pressed meanwhile.";
        if (std::string why = refused_press(action); !why.empty()) return why;
        const bool dark = action == OperatorAction::dark || action == OperatorAction::stop;
        const SessionState from = dark ? without_waiting() : state_;
        if (dark) {
            // What asks for no light stays: an item that was hidden must not be lit afterwards.
            std::erase_if(presses_, [](const Press& press) { return !is_of_items(press.action); });
            ++darks_;
            light_ = {nullptr, light_.number + 1};
        }
        if (action == OperatorAction::scan) scan_there_ = false;  // the former one is given up
        const SessionState next = after_press(from, action, scan_there_).value_or(from);
        if (next != state_ && (dark || !(next == SessionState::verifying || state_ == SessionState::unsure)))
            enter(next, blank_, model_, scan_there_);
        presses_.push_back({action, darks_, state_, item, by});
        state_ = next;
        if (dark) model_.status = dark_status(state_, scan_there_);
        if (action == OperatorAction::confirm) model_.confirm = false;  // until there is something new to look at
    }
    wake_.notify_all();
    if (observer_ && by == AskedBy::person) observer_->pressed(kActions.at(static_cast<std::size_t>(action)));
    if (observer_ && by == AskedBy::lost_projector) observer_->pressed("projector_lost");
    return {};
}

std::string LiveSession::post_find_patient(std::vector<PointPair> landmarks) {
    {
        const std::lock_guard lock(mutex_);
        landmarks_ = std::move(landmarks);
    }
    return post(OperatorAction::do_register);
}

std::string LiveSession::post_item(OperatorAction action, std::optional<std::size_t> which) {
    return post(action, AskedBy::person, which);
}

bool LiveSession::happened(SessionHappening happening, const std::function<void(OperatorModel&)>& change) {
    // Of these there are words where they lead nowhere, too; the others were overtaken by DARK then.
    const bool may_stay = happening == SessionHappening::failed || happening == SessionHappening::skin_checked;
    {
        const std::lock_guard lock(mutex_);
        if (view_of(state_).lights && permitted_ != darks_) return false;
        const SessionState next = after(state_, happening);
        if (happening == SessionHappening::scan_done && next != state_) scan_there_ = true;
        if (next == state_ && !(may_stay && change)) return false;
        if (next != state_) enter(next, blank_, model_, scan_there_);
        state_ = next;
        if (change) change(model_);
    }
    said();
    return true;
}

/// Tells the observer what the banner says.
void LiveSession::said() {
    if (!observer_) return;
    const Status status = model().status;
    observer_->said(kStatusKinds.at(static_cast<std::size_t>(status.kind)), status.headline, status.details);
}

OperatorModel LiveSession::model() const {
    const std::lock_guard lock(mutex_);
    OperatorModel now = model_;
    view_.put_into(now);
    if (darks_answered_ != darks_) {
        now.status = dark_status(state_, scan_there_);  // DARK was pressed, and the thread is still at something else
        now.scene.light = nullptr;
        now.confirm = now.check_skin = false;
    }
    if (light_stays_) {
        now.status = light_stays_status();
        now.light_stays = now.light_on = true;
    }
    return now;
}

/// In place of whatever else is to be said, until it is dark or light is asked for.
void LiveSession::say_whether_light_stays(bool stays) {
    {
        const std::lock_guard lock(mutex_);
        if (light_stays_ == stays) return;
        light_stays_ = stays;
    }
    if (observer_) observer_->light_stays(stays);
    said();
}

LiveSession::Light LiveSession::light() const {
    const std::lock_guard lock(mutex_);
    return light_;
}

UpdateLatency LiveSession::latency() const {
    const std::lock_guard lock(mutex_);
    return latency_;
}

bool LiveSession::projecting() const {
    return projecting_;
}

void LiveSession::rethrow_fault() const {
    const std::lock_guard lock(mutex_);
    if (fault_) std::rethrow_exception(fault_);
}

void LiveSession::show_alive() {
    alive_at_ = SteadyClock().now().count();
}

/// The light of this press may be shown, unless DARK was pressed after it.
void LiveSession::permit_light(const Press& press) {
    const std::lock_guard lock(mutex_);
    permitted_ = press.darks;
}

bool LiveSession::light_permitted() const {
    const std::lock_guard lock(mutex_);
    return permitted_ == darks_;
}

/// Waits for one, `longest` at most; 0: not at all.
LiveSession::Press LiveSession::next_press(Instant longest) {
    std::unique_lock lock(mutex_);
    if (longest > Instant{}) wake_.wait_for(lock, longest, [&] { return ending_ || !presses_.empty(); });
    if (ending_) return {OperatorAction::quit, darks_};
    if (presses_.empty()) return {OperatorAction::none, darks_};
    const Press press = presses_.front();
    presses_.pop_front();
    return press;
}

}  // namespace planlight
