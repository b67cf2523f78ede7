// What a session can be asked for, told to its observer before and after.
#include "app/session.h"
#include "app/session_observer.h"

namespace planlight {

SessionSettings settings_for(const MarkerDesign& markers) {
    SessionSettings settings;
    settings.tracking = tracking_settings_for(markers);
    return settings;
}

template <class Do>
void Session::told(SessionCall call, const Do& body, const std::vector<PointPair>& landmarks, int which) {
    if (settings_.observer) settings_.observer->asked(call, landmarks, which);
    try {
        body();
    } catch (const std::exception& why) {
        if (settings_.observer) settings_.observer->refused(call, why);
        throw;
    }
}

std::function<void(int, int)> Session::told_when_stopped(const std::function<void(int, int)>& progress) const {
    if (!settings_.observer || !progress) return progress;
    return [this, &progress](int done, int of) {
        try {
            progress(done, of);
        } catch (const Error& why) {
            settings_.observer->stopped(why);
            throw;
        }
    };
}

const ScanResult& Session::scan(const std::function<void(int, int)>& progress) {
    told(SessionCall::scan, [&] { make_scan(told_when_stopped(progress)); });
    if (settings_.observer) settings_.observer->scanned(*this);
    return *scanned_;
}

const RegistrationResult& Session::find_patient(const std::vector<PointPair>& landmarks) {
    told(
        SessionCall::find_patient, [&] { match(landmarks); }, landmarks);
    if (settings_.observer) settings_.observer->matched(*this);
    return *registration_;
}

void Session::confirm() {
    told(SessionCall::confirm, [&] {
        confirmed_ = true;
        if (overlay_) overlay_->set_operator_confirmed(true);
    });
}

void Session::light_landmark(std::optional<std::size_t> which) {
    if (which == lit_landmark_) return;
    const auto light = [&] {
        overlay_.reset();
        lit_landmark_ = which && *which < landmarks().size() ? which : std::nullopt;
        if (lit_landmark_)
            card_wanted_ = false;
        else
            landmarks_.reset();  // next time the head may lie elsewhere
    };
    told(SessionCall::light_landmark, light, {}, which ? static_cast<int>(*which) : -1);
}

void Session::light_item(std::optional<std::size_t> which) {
    if (which == item_of_moment_) return;
    const auto light = [&] {
        overlay_.reset();
        item_of_moment_ = which && *which < drawing().items.size() ? which : std::nullopt;
        std::set<std::size_t> hidden = hidden_;
        if (item_of_moment_ && hidden.erase(*item_of_moment_) > 0) set_hidden(std::move(hidden));
    };
    told(SessionCall::light_item, light, {}, which ? static_cast<int>(*which) : -1);
}

void Session::hide_item(std::size_t which) {
    if (which >= drawing().items.size() || hidden_.contains(which)) return;
    const auto hide = [&] {
        overlay_.reset();
        if (item_of_moment_ == which) item_of_moment_.reset();
        std::set<std::size_t> hidden = hidden_;
        hidden.insert(which);
        set_hidden(std::move(hidden));
    };
    told(SessionCall::hide_item, hide, {}, static_cast<int>(which));
}

void Session::show_item(std::optional<std::size_t> which) {
    if (which ? !hidden_.contains(*which) : hidden_.empty() && !item_of_moment_) return;
    const auto show = [&] {
        overlay_.reset();
        std::set<std::size_t> hidden = hidden_;
        if (which)
            hidden.erase(*which);
        else
            hidden.clear(), item_of_moment_.reset();
        set_hidden(std::move(hidden));
    };
    told(SessionCall::show_item, show, {}, which ? static_cast<int>(*which) : -1);
}

/// The light that is on was made of the drawing as it was: the caller has given it up.
void Session::set_hidden(std::set<std::size_t> hidden) {
    hidden_ = std::move(hidden);
    without_hidden_.reset();
    if (hidden_.empty()) return;
    const auto is_hidden = [&](const auto& drawn) {
        return drawn.item >= 0 && hidden_.contains(static_cast<std::size_t>(drawn.item));
    };
    without_hidden_ = drawing();
    std::erase_if(without_hidden_->strokes, is_hidden);
    std::erase_if(without_hidden_->labels, is_hidden);
}

/// Items that this plan does not have are passed over.
void Session::light_part(const LitPart& part) {
    const std::size_t count = drawing().items.size();
    item_of_moment_ = part.item_of_moment && *part.item_of_moment < count ? part.item_of_moment : std::nullopt;
    card_wanted_ = part.card;
    std::set<std::size_t> hidden = part.hidden;
    std::erase_if(hidden, [&](std::size_t item) { return item >= count; });
    set_hidden(std::move(hidden));
}

Session::Update Session::update() {
    Update update;
    told(SessionCall::update, [&] { update = make_update(); });
    if (settings_.observer) settings_.observer->updated(*this, update);
    return update;
}

SkinCheck Session::check_skin(const std::function<void(int, int)>& progress) {
    SkinCheck check;
    told(SessionCall::check_skin, [&] { check = measure_skin(told_when_stopped(progress)); });
    if (settings_.observer) settings_.observer->skin_checked(check);
    return check;
}

ResumeCheck Session::resume(const KeptMatch& match, const std::function<void(int, int)>& progress) {
    ResumeCheck check;
    if (settings_.observer) settings_.observer->match_offered(match);
    told(SessionCall::resume, [&] { check = take_up(match, told_when_stopped(progress)); });
    if (settings_.observer) settings_.observer->resumed(*this, check);
    return check;
}

void Session::go_dark() noexcept {
    devices_.darken_first();
    if (settings_.observer) settings_.observer->asked(SessionCall::go_dark, {}, -1);
    darken();
}

}  // namespace planlight
