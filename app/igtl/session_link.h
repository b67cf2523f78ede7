#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "app/igtl/linked_values.h"
#include "app/igtl/newest_value.h"
#include "app/recording/anonymous.h"
#include "app/session_observer.h"
#include "planning_io/case/case_folder.h"

namespace planlight {

struct SessionLinkSettings {
    MessageServerSettings server;
    bool names = false;  ///< of patient, case, plan and its items; else they are in nothing that is sent
    std::chrono::milliseconds alive_every{1000};  ///< the gate's word is said again
    std::chrono::milliseconds stale_after{1500};  ///< without a word of a session that has light
};

/// Tells other systems of a session by OpenIGTLink, and hears nothing from them.
///
/// The session's thread writes values into a mailbox in which the newest wins, and goes on; a thread of the link's own,
/// which gives way to the session's, makes messages of them and sends them. Each new client is given skin and plan
/// once.
class SessionLink final : public SessionObserver {
public:
    /// Listens from here on. Throws as `MessageServer`.
    SessionLink(const Case& the_case, const SessionLinkSettings& settings = {});
    ~SessionLink() override;  ///< says that it ends

    int port() const { return server_.port(); }
    MessageServerCounts counts() const { return server_.counts(); }

    void room_entered(const RoomFacts& room) noexcept override;
    void asked(SessionCall call, const std::vector<PointPair>& landmarks, int which) noexcept override;
    void match_offered(const KeptMatch& match) noexcept override;
    void clock_read(Instant now) noexcept override;
    void light_stays(bool stays) noexcept override;
    void device_failed(const Error& fault) noexcept override;
    void matched(const Session& session) noexcept override;
    void resumed(const Session& session, const ResumeCheck& check) noexcept override;
    void updated(const Session& session, const Session::Update& update) noexcept override;
    void refused(SessionCall call, const std::exception& why) noexcept override;
    void gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling) noexcept override;

private:
    template <class Change>
    void tell(const Change& change) noexcept;
    void dark(const std::string& why, bool stays = false);
    void say(LightTrust trust, const std::string& words);
    void match_is(const Session& session, bool confirmed);
    void run(LinkedValues told);

    const SessionLinkSettings settings_;
    std::mutex mutex_;  ///< of those who tell; never of the link's own thread
    std::optional<NamesLeftOut> left_out_;
    std::optional<RigidTransform> unconfirmed_;  ///< a match that waits for a person's look
    bool offered_confirmed_ = false;
    Instant room_now_{};
    std::string raw_words_;
    std::string hidden_words_;  ///< how much of the plan is hidden; empty: nothing
    bool dark_stays_ = false;   ///< why it is dark: that it is put out then says nothing new
    bool light_stays_ = false;  ///< it was put out and is still seen: that is said in place of all else
    LinkedValues values_;
    NewestValue<LinkedValues> mailbox_;
    MessageServer server_;
    std::atomic<bool> ending_{false};
    std::thread thread_;
};

}  // namespace planlight
