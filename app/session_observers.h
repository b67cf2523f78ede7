#pragma once

#include <vector>

#include "app/session_observer.h"

namespace planlight {

/// Tells several observers of a session, one after the other, of the same.
class SessionObservers final : public SessionObserver {
public:
    /// Null ones are left out; the others outlive this.
    void add(SessionObserver* observer) {
        if (observer) observers_.push_back(observer);
    }
    /// Whom a session is to tell: null where there is nobody.
    SessionObserver* all() { return observers_.empty() ? nullptr : observers_.size() == 1 ? observers_.front() : this; }

    void room_entered(const RoomFacts& room) noexcept override { each(&SessionObserver::room_entered, room); }
    void pressed(const std::string& action) noexcept override { each(&SessionObserver::pressed, action); }
    void said(const std::string& kind, const std::string& headline,
              const std::vector<std::string>& details) noexcept override {
        each(&SessionObserver::said, kind, headline, details);
    }
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override {
        each(&SessionObserver::asked, call, landmarks, which);
    }
    void match_offered(const KeptMatch& match) noexcept override { each(&SessionObserver::match_offered, match); }
    void clock_read(Instant now) noexcept override { each(&SessionObserver::clock_read, now); }
    void frame_exposed() noexcept override { each(&SessionObserver::frame_exposed); }
    void frame_taken(const StereoFrame& frame) noexcept override { each(&SessionObserver::frame_taken, frame); }
    void picture_shown(const RgbImage& picture, Instant valid_until, Instant lit_from) noexcept override {
        each(&SessionObserver::picture_shown, picture, valid_until, lit_from);
    }
    void went_dark() noexcept override { each(&SessionObserver::went_dark); }
    void cameras_doubted(const std::string& doubt) noexcept override { each(&SessionObserver::cameras_doubted, doubt); }
    void light_stays(bool stays) noexcept override { each(&SessionObserver::light_stays, stays); }
    void device_failed(const Error& fault) noexcept override { each(&SessionObserver::device_failed, fault); }
    void stopped(const Error& why) noexcept override { each(&SessionObserver::stopped, why); }
    void scanned(const Session& session) noexcept override { each(&SessionObserver::scanned, session); }
    void matched(const Session& session) noexcept override { each(&SessionObserver::matched, session); }
    void updated(const Session& session, const Session::Update& update) noexcept override {
        each(&SessionObserver::updated, session, update);
    }
    void skin_checked(const SkinCheck& check) noexcept override { each(&SessionObserver::skin_checked, check); }
    void resumed(const Session& session, const ResumeCheck& check) noexcept override {
        each(&SessionObserver::resumed, session, check);
    }
    void refused(SessionCall call, const std::exception& why) noexcept override {
        each(&SessionObserver::refused, call, why);
    }
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override {
        each(&SessionObserver::gate, call, at, off_mm, ruling);
    }

private:
    template <class... Parameters, class... Arguments>
    void each(void (SessionObserver::*tell)(Parameters...) noexcept, const Arguments&... arguments) noexcept {
        for (SessionObserver* observer : observers_) (observer->*tell)(arguments...);
    }
    std::vector<SessionObserver*> observers_;
};

}  // namespace planlight
