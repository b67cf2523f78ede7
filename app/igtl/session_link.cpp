#include "app/igtl/session_link.h"

#include <sys/resource.h>

#include <fmt/ranges.h>

#include "app/igtl/igtl_messages.h"
#include "app/igtl/linked_shapes.h"
#include "planning_io/types/utf8_prefix.h"

namespace planlight {
namespace {

using SteadyClockOfWall = std::chrono::steady_clock;

double utc_now_s() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

MessageServer::Message made(std::string bytes) {
    return std::make_shared<const std::string>(std::move(bytes));
}

MessageServerSettings server_settings(MessageServerSettings settings) {
    settings.when_full = status_message({"Gate", utc_now_s()}, LinkCode::busy, 0, "full",
                                        "As many systems listen to this session as may.");
    return settings;
}

/// No more than a line of it, and no half a character at its end.
std::string shortened(const std::string& text) {
    constexpr std::size_t kMost = 480;
    return text.size() <= kMost ? text : std::string(utf8_prefix(text, kMost)) + "…";
}

LinkedValues values_of_light_that_stays(LinkedValues values) {
    values.trust = LightTrust::dark;
    values.words = "Light that was put out is still seen on the patient: it does not go out.";
    values.off_mm = values.sigma_mm = std::nullopt;
    return values;
}

}  // namespace

SessionLink::SessionLink(const Case& the_case, const SessionLinkSettings& settings)
    : settings_(settings), server_(server_settings(settings.server)) {
    const double utc_s = utc_now_s();
    std::vector<MessageServer::Message> first{made(shapes_message({"Skin", utc_s}, shapes_of(the_case.skin))),
                                              made(shapes_message({"Plan", utc_s}, shapes_of(the_case.plan)))};
    if (settings_.names)
        first.push_back(made(string_message({"Case", utc_s}, title_of(the_case))));
    else
        left_out_.emplace(the_case);
    server_.set_first(std::move(first));
    values_.said_utc_s = utc_s;
    set_messages(server_, values_, nullptr);
    thread_ = std::thread([this, first = values_] { run(first); });
}

SessionLink::~SessionLink() {
    ending_ = true;
    server_.wake();
    thread_.join();
    try {
        server_.say_at_the_end(
            made(status_message({"Gate", utc_now_s()}, LinkCode::shut_down, 0, "ended", "The session has ended.")));
    } catch (const std::exception&) {  // no memory: the end is not said, and seen all the same
    }
}

void SessionLink::run(LinkedValues told) {
    constexpr int kGivesWay = 10;
    ::setpriority(PRIO_PROCESS, 0, kGivesWay);  // on Linux of this thread alone
    LinkedValues next;
    auto heard_at = SteadyClockOfWall::now(), said_at = heard_at;
    bool stale = false;
    const auto longest = std::min(settings_.alive_every, settings_.stale_after) / 4;
    const auto turn = [&] {
        const auto at = SteadyClockOfWall::now();
        if (mailbox_.take(next)) {
            set_messages(server_, next, stale ? nullptr : &told);
            told = next;
            stale = false;
            heard_at = said_at = at;
        } else if (told.trust != LightTrust::dark && at - heard_at > settings_.stale_after) {
            if (!stale || at - said_at > settings_.alive_every) set_stale_messages(server_, utc_now_s()), said_at = at;
            stale = true;
        } else if (at - said_at > settings_.alive_every) {
            set_gate_message(server_, told, utc_now_s());
            said_at = at;
        } else {
            server_.turn(longest);  // a word of the session ends it
            return;
        }
        server_.turn(std::chrono::milliseconds(0));
        if (stale) server_.turn(longest);
    };
    while (!ending_) {
        try {
            turn();
        } catch (const std::exception&) {  // no memory: listeners wait, and the session goes on
            std::this_thread::sleep_for(longest);
        }
    }
}

/// A link that fails (no memory) must not take the session with it.
template <class Change>
void SessionLink::tell(const Change& change) noexcept {
    try {
        const std::lock_guard lock(mutex_);
        change();
        mailbox_.give(light_stays_ ? values_of_light_that_stays(values_) : values_);
        server_.wake();
    } catch (const std::exception&) {
    }
}

void SessionLink::say(LightTrust trust, const std::string& words) {
    if (trust != values_.trust) values_.said_utc_s = utc_now_s();
    values_.trust = trust;
    dark_stays_ = false;
    if (words == raw_words_) return;
    raw_words_ = words;
    values_.words = shortened(left_out_ ? left_out_->text_without(words) : words);
    values_.said_utc_s = utc_now_s();
}

/// `stays`: the light has been stopped, or refused, for this reason, and DARK says no more.
void SessionLink::dark(const std::string& why, bool stays) {
    say(LightTrust::dark, why);
    dark_stays_ = stays;
    values_.off_mm = values_.sigma_mm = std::nullopt;
}

void SessionLink::room_entered(const RoomFacts& room) noexcept {
    tell([&] {
        room_now_ = room.now;
        dark("No light was asked for yet.");
    });
}

void SessionLink::clock_read(Instant now) noexcept {
    const std::lock_guard lock(mutex_);
    room_now_ = now;
}

void SessionLink::asked(SessionCall call, const std::vector<PointPair>&, int) noexcept {
    if (call == SessionCall::update || call == SessionCall::light_item || call == SessionCall::light_landmark ||
        call == SessionCall::hide_item || call == SessionCall::show_item)
        return;
    tell([&] {
        if (call == SessionCall::confirm) {
            if (unconfirmed_) values_.patient_from_ct = unconfirmed_, values_.matched_utc_s = utc_now_s();
            unconfirmed_.reset();
            return;
        }
        values_.rig_from_patient.reset();
        if (call == SessionCall::go_dark) {
            if (!dark_stays_) dark("The light was put out.");
            return;
        }
        if (call == SessionCall::check_skin) return dark("A short scan looks whether the skin is where it was.");
        // A new scan is a new patient frame: the match of before means nothing in it.
        values_.patient_from_ct.reset();
        unconfirmed_.reset();
        dark(call == SessionCall::scan           ? "The patient is being scanned."
             : call == SessionCall::find_patient ? "The patient is being found in the CT."
                                                 : "A short scan looks whether the last match still holds.");
    });
}

void SessionLink::match_offered(const KeptMatch& match) noexcept {
    const std::lock_guard lock(mutex_);
    offered_confirmed_ = match.confirmed;
}

/// What needs a person's look is said to nobody before it has had it.
void SessionLink::match_is(const Session& session, bool confirmed) {
    if (left_out_) left_out_->add_items(session.drawing());
    const RegistrationResult* found = session.registration();
    values_.patient_from_ct.reset();
    unconfirmed_.reset();
    if (!found || found->verdict == Verdict::no) return dark("The patient was not found.");
    if (found->verdict == Verdict::ask && !confirmed) {
        unconfirmed_ = found->patient_from_ct;
        return dark("The match needs a person's look.");
    }
    values_.patient_from_ct = found->patient_from_ct;
    values_.matched_utc_s = utc_now_s();
    dark("The patient was found; no light was asked for yet.");
}

void SessionLink::matched(const Session& session) noexcept {
    tell([&] { match_is(session, false); });
}

void SessionLink::resumed(const Session& session, const ResumeCheck&) noexcept {
    tell([&] { match_is(session, offered_confirmed_); });
}

void SessionLink::updated(const Session& session, const Session::Update& update) noexcept {
    tell([&] {
        const std::size_t hidden = session.hidden_items().size();
        hidden_words_ = hidden == 0 ? ""
                                    : fmt::format(" {} of {} items {} hidden.", hidden, session.drawing().items.size(),
                                                  hidden == 1 ? "is" : "are");
        values_.rig_from_patient = update.pose.rig_from_patient;
        values_.predicted_error_mm = update.pose.predicted_error_mm;
        values_.bound_95_mm = update.pose.bound_95_mm;
        const double age_s = std::max(0.0, seconds(room_now_ - update.pose.at));
        values_.seen_utc_s = utc_now_s() - age_s;
        if (!update.overlay.lit)
            dark("Dark: " + (update.overlay.reason.empty() ? update.pose.reason : update.overlay.reason) + ".");
    });
}

void SessionLink::light_stays(bool stays) noexcept {
    tell([&] {
        light_stays_ = stays;
        values_.said_utc_s = utc_now_s();
    });
}

void SessionLink::device_failed(const Error& fault) noexcept {
    tell([&] {
        values_.rig_from_patient.reset();
        dark(std::string("Dark: ") + fault.what() + ".", true);
    });
}

void SessionLink::refused(SessionCall, const std::exception& why) noexcept {
    tell([&] {
        values_.rig_from_patient.reset();
        dark(std::string("Dark: ") + why.what() + ".", true);
    });
}

void SessionLink::gate(GateCall, Instant, double, const LightGate::Ruling* ruling) noexcept {
    if (!ruling) return;
    tell([&] {
        if (ruling->trust == LightTrust::dark && ruling->headline.empty()) {  // for a reason that was said before
            dark(raw_words_, dark_stays_);
            return;
        }
        const std::string part = ruling->trust == LightTrust::dark ? "" : hidden_words_;
        say(ruling->trust, fmt::format("{}{} {}", ruling->headline, part, fmt::join(ruling->details, " ")));
        dark_stays_ = ruling->stop;
        values_.off_mm = ruling->off_mm;
        values_.sigma_mm = ruling->sigma_mm;
    });
}

}  // namespace planlight
