// A whole session in the simulated room, as another system hears of it.
#include "app/igtl/session_link.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "app/session_observers.h"
#include "planning_io/types/error.h"
#include "registration/simulation/simulated_rig.h"
#include "tests/app/igtl/igtl_receiver.h"
#include "tests/app/played_session.h"

namespace planlight {
namespace {

using test::ReceivedMessage;

const Eigen::Matrix4d kFlip = Eigen::Vector4d(-1, -1, 1, 1).asDiagonal();

/// What the session itself had.
class Watcher final : public SessionObserver {
public:
    void matched(const Session& session) noexcept override {
        patient_from_ct = session.registration()->patient_from_ct;
    }
    void updated(const Session&, const Session::Update& update) noexcept override {
        if (update.pose.rig_from_patient) poses.push_back(*update.pose.rig_from_patient);
    }
    RigidTransform patient_from_ct = RigidTransform::Identity();
    std::vector<RigidTransform> poses;
};

/// A session of a case with names in it, heard from its beginning to its end.
struct HeardSession {
    Watcher session;
    std::vector<ReceivedMessage> messages;
    test::ExampleCase patient;
};

HeardSession hear() {
    HeardSession heard;
    heard.patient = test::example_case();
    heard.patient.prepared.names.patient = "Erika Mustermann";
    heard.patient.prepared.names.title = "Erika Mustermann, frontal defect";
    for (auto& line : heard.patient.prepared.plan.osteotomy_lines) line.name = "Erika's line";
    SessionLinkSettings settings;
    settings.server.port = 0;
    auto link = std::make_unique<SessionLink>(heard.patient.prepared, settings);
    test::IgtlReceiver receiver(link->port());
    SessionObservers both;
    both.add(&heard.session);
    both.add(nullptr);
    both.add(link.get());
    test::PlayedSession how;
    how.seed = 1;  // a room in which the cameras can measure every item
    how.updates = 90;
    test::play_session(how, heard.patient, both.all());
    link.reset();
    heard.messages = receiver.all();
    return heard;
}

std::vector<ReceivedMessage> of(const HeardSession& heard, const std::string& device) {
    std::vector<ReceivedMessage> found;
    std::copy_if(heard.messages.begin(), heard.messages.end(), std::back_inserter(found),
                 [&](const ReceivedMessage& message) { return message.device == device; });
    return found;
}

bool has_word(const HeardSession& heard, const std::string& word, int code) {
    const auto gate = of(heard, "Gate");
    return std::any_of(gate.begin(), gate.end(), [&](const ReceivedMessage& status) {
        return status.word == word && status.code == code && !status.text.empty();
    });
}

void expect_sound(const HeardSession& heard) {
    EXPECT_GT(heard.messages.size(), 60u);
    for (const ReceivedMessage& message : heard.messages) EXPECT_TRUE(message.sound) << message.device;
}

void expect_skin_and_plan_once_and_first(const HeardSession& heard) {
    ASSERT_GE(heard.messages.size(), 2u);
    const ReceivedMessage &skin = heard.messages[0], &plan = heard.messages[1];
    EXPECT_EQ(skin.device, "Skin");
    EXPECT_EQ(skin.points, static_cast<int>(heard.patient.prepared.skin.vertices_in_ct.size()));
    EXPECT_EQ(skin.polygons, static_cast<int>(heard.patient.prepared.skin.triangles.size()));
    EXPECT_EQ(plan.device, "Plan");
    EXPECT_GE(plan.lines, static_cast<int>(heard.patient.prepared.plan.osteotomy_lines.size()));
    EXPECT_EQ(of(heard, "Skin").size(), 1u);
    EXPECT_EQ(of(heard, "Plan").size(), 1u);
}

void expect_match_in_slicers_axes(const HeardSession& heard) {
    const auto match = of(heard, "T_ini");
    ASSERT_FALSE(match.empty());  // said once more after each time that the session was slow enough to be called stale
    const Eigen::Matrix4d expected = kFlip * heard.session.patient_from_ct.matrix() * kFlip;
    for (const ReceivedMessage& one : match)
        EXPECT_LT((one.matrix - expected).cwiseAbs().maxCoeff(), 2e-4);  // 32 bit at a metre
}

void expect_poses_of_the_session(const HeardSession& heard) {
    const auto poses = of(heard, "Poses");
    ASSERT_GT(poses.size(), 10u);
    for (const ReceivedMessage& pose : poses) {
        const Eigen::Matrix4d& cur = pose.transforms.at("T_cur");
        EXPECT_TRUE(std::any_of(heard.session.poses.begin(), heard.session.poses.end(), [&](const auto& p) {
            return (kFlip * p.matrix() * kFlip - cur).cwiseAbs().maxCoeff() < 2e-4;
        }));
        // T_global = T_cur T_ini
        EXPECT_LT((pose.transforms.at("T_global") - cur * pose.transforms.at("T_ini")).cwiseAbs().maxCoeff(), 1e-3);
    }
    EXPECT_GT(of(heard, "T_cur").size(), 10u);
    EXPECT_GT(of(heard, "T_global").size(), 10u);
}

void expect_words_of_the_gate(const HeardSession& heard) {
    EXPECT_TRUE(has_word(heard, "dark", 15));
    EXPECT_TRUE(has_word(heard, "look", 13));
    EXPECT_TRUE(has_word(heard, "aligned", 1));
    EXPECT_EQ(heard.messages.back().word, "ended");
    EXPECT_EQ(heard.messages.back().code, 19);
}

void expect_errors_in_mm(const HeardSession& heard) {
    for (const char* device : {"LightError", "PoseError"}) {
        const auto errors = of(heard, device);
        ASSERT_FALSE(errors.empty()) << device;
        for (const ReceivedMessage& error : errors) {
            EXPECT_TRUE(error.in_mm);
            ASSERT_EQ(error.numbers.size(), 2u);
            EXPECT_GE(error.numbers[0], 0);
            EXPECT_LT(error.numbers[0], 5);
        }
    }
}

void expect_no_names(const HeardSession& heard) {
    EXPECT_TRUE(of(heard, "Case").empty());
    for (const ReceivedMessage& message : heard.messages)
        EXPECT_EQ(message.text.find("Erika"), std::string::npos) << message.text;
}

TEST(SessionLink, AnotherSystemHearsASessionAsItWas) {
    if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    const HeardSession heard = hear();
    expect_sound(heard);
    expect_skin_and_plan_once_and_first(heard);
    expect_match_in_slicers_axes(heard);
    expect_poses_of_the_session(heard);
    expect_words_of_the_gate(heard);
    expect_errors_in_mm(heard);
    expect_no_names(heard);
}

/// A session each of whose matches needs a person's look, and a link on it.
class DoubtingSession {
public:
    DoubtingSession() : room_(test::example_case().volume, {}, papers_room()) {
        SessionLinkSettings settings;
        settings.server.port = 0;
        link_ = std::make_unique<SessionLink>(test::example_case().prepared, settings);
        receiver_ = std::make_unique<test::IgtlReceiver>(link_->port());
        SessionSettings doubting;
        doubting.registration.min_agreeing_bases = 1000;  // every match is an `ask`
        doubting.observer = link_.get();
        session_ = std::make_unique<Session>(test::example_case().prepared, drawing_, room_.calibration(),
                                             room_.projector(), room_.cameras(), room_.clock(), doubting);
        while (link_->counts().clients == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    Session& session() { return *session_; }
    SessionLink& link() { return *link_; }
    void match_and_follow() {
        ASSERT_EQ(session_->find_patient().verdict, Verdict::ask);
        let_it_be_sent();
        follow();
    }
    void confirm_and_follow() {
        session_->confirm();
        let_it_be_sent();
        follow();
    }
    /// All that was heard, after the session.
    std::vector<ReceivedMessage> heard() {
        session_.reset();
        link_.reset();
        return receiver_->all();
    }

    /// The newest word wins: each of these is one that is taken.
    static void let_it_be_sent() { std::this_thread::sleep_for(std::chrono::milliseconds(400)); }

private:
    static simulation::RoomSettings papers_room() {
        simulation::RoomSettings settings;
        settings.preset = simulation::Preset::paper;
        return settings;
    }
    void follow() {
        for (int i = 0; i < 3; ++i) session_->update();
        let_it_be_sent();
    }
    simulation::SimulatedRig room_;
    const CaseDrawing drawing_{test::example_case().prepared};
    std::unique_ptr<SessionLink> link_;
    std::unique_ptr<test::IgtlReceiver> receiver_;
    std::unique_ptr<Session> session_;
};

/// Whether it tells where the CT lies, in whatever message.
bool tells_of_the_match(const ReceivedMessage& message) {
    return message.device == "T_ini" || message.device == "T_global" || message.transforms.contains("T_ini") ||
           message.transforms.contains("T_global");
}

TEST(SessionLink, AMatchThatNeedsAPersonsLookIsSaidToNobodyBeforeItHasHadIt) {
    if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    DoubtingSession doubting;
    doubting.session().scan();
    doubting.match_and_follow();
    doubting.confirm_and_follow();
    doubting.match_and_follow();  // another match: the word was for the one before
    const auto all = doubting.heard();
    const auto asks = [](const ReceivedMessage& m) {
        return m.device == "Gate" && m.text.find("needs a person's look") != std::string::npos;
    };
    const auto first_ask = std::find_if(all.begin(), all.end(), asks);
    ASSERT_NE(first_ask, all.end());
    const auto told = std::find_if(all.begin(), all.end(), tells_of_the_match);
    ASSERT_NE(told, all.end()) << "it was never said, though it was confirmed";
    EXPECT_LT(first_ask - all.begin(), told - all.begin());
    EXPECT_EQ(told->device, "T_ini");
    EXPECT_TRUE(std::any_of(first_ask, told, [](const ReceivedMessage& m) { return m.device == "T_cur"; }))
        << "the head was followed meanwhile";
    const auto second_ask = std::find_if(told, all.end(), asks);
    ASSERT_NE(second_ask, all.end());
    EXPECT_TRUE(std::any_of(told, second_ask, [](const ReceivedMessage& m) { return m.device == "T_global"; }));
    EXPECT_TRUE(std::none_of(second_ask, all.end(), tells_of_the_match)) << "of a match that nobody has looked at";
}

/// All that another system hears of this case, and of a gate that names an item.
std::vector<ReceivedMessage> heard_of(const Case& the_case, bool names) {
    SessionLinkSettings settings;
    settings.server.port = 0;
    settings.names = names;
    auto link = std::make_unique<SessionLink>(the_case, settings);
    LightGate::Ruling ruling;
    ruling.trust = LightTrust::look;
    ruling.headline = "LOOK: \"Erika's line\" is not measured.";
    link->gate(GateCall::step, {}, 0, &ruling);
    test::IgtlReceiver receiver(link->port());
    while (link->counts().clients == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    link.reset();
    return receiver.all();
}

bool says(const std::vector<ReceivedMessage>& all, const std::string& device, const std::string& words) {
    return std::any_of(all.begin(), all.end(), [&](const ReceivedMessage& message) {
        return message.device == device && message.text.find(words) != std::string::npos;
    });
}

TEST(SessionLink, ThatAPartOfThePlanIsHiddenIsSaidWithTheGatesWord) {
    if (!test::example_case().there) GTEST_SKIP() << "the package invesalius-examples is not installed";
    DoubtingSession doubting;
    doubting.session().scan();
    doubting.match_and_follow();
    doubting.session().hide_item(0);
    doubting.confirm_and_follow();
    LightGate::Ruling ruling;
    ruling.trust = LightTrust::aligned;
    ruling.headline = "The plan is on the skin.";
    ruling.details = {"Measured by the cameras."};
    doubting.link().gate(GateCall::step, {}, 0, &ruling);
    DoubtingSession::let_it_be_sent();
    const std::string part = "1 of " + std::to_string(doubting.session().drawing().items.size()) + " items is hidden.";
    EXPECT_TRUE(says(doubting.heard(), "Gate", "The plan is on the skin. " + part + " Measured"));
}

/// The gate's last word before the end, of a link that was told this.
ReceivedMessage last_gate_of(const std::function<void(SessionLink&)>& told) {
    const Case the_case;
    SessionLinkSettings settings;
    settings.server.port = 0;
    auto link = std::make_unique<SessionLink>(the_case, settings);
    told(*link);
    test::IgtlReceiver receiver(link->port());
    while (link->counts().clients == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    link.reset();
    ReceivedMessage last;
    for (const ReceivedMessage& message : receiver.all())
        if (message.device == "Gate" && message.word != "ended") last = message;
    return last;
}

TEST(SessionLink, LightThatDoesNotGoOutIsSaidInPlaceOfAllElseUntilItHasGone) {
    LightGate::Ruling aligned;
    aligned.trust = LightTrust::aligned;
    aligned.headline = "The plan is on the skin.";
    const auto stays = [&](SessionLink& link) {
        link.gate(GateCall::step, {}, 0, &aligned);
        link.light_stays(true);
        link.gate(GateCall::step, {}, 0, &aligned);
    };
    const ReceivedMessage told = last_gate_of(stays);
    EXPECT_EQ(told.word, "dark");
    EXPECT_NE(told.text.find("it does not go out"), std::string::npos) << told.text;
    EXPECT_NE(last_gate_of([&](SessionLink& link) {
                  stays(link);
                  link.asked(SessionCall::go_dark, {}, -1);
              }).text.find("it does not go out"),
              std::string::npos);
    EXPECT_EQ(last_gate_of([&](SessionLink& link) {
                  stays(link);
                  link.light_stays(false);
              }).word,
              "aligned");
}

TEST(SessionLink, DarkThatWasPressedIsTheReasonUnlessTheLightWasStopped) {
    const auto last_word = [](const std::function<void(SessionLink&)>& before) {
        return last_gate_of([&](SessionLink& link) {
                   before(link);
                   link.asked(SessionCall::go_dark, {}, -1);
               })
            .text;
    };
    const auto look = [](SessionLink& link) {
        LightGate::Ruling ruling;
        ruling.trust = LightTrust::look;
        ruling.headline = "LOOK: the light is being measured.";
        link.gate(GateCall::step, {}, 0, &ruling);
    };
    EXPECT_EQ(last_word(look), "The light was put out.");
    EXPECT_EQ(last_word([](SessionLink& link) { link.room_entered({}); }), "The light was put out.");
    EXPECT_EQ(last_word([](SessionLink& link) {
                  link.device_failed(DeviceError("Left camera", "no frame came in 250 ms", "Look at its cable."));
              }),
              "Dark: Left camera: no frame came in 250 ms.");
    EXPECT_EQ(last_word([&](SessionLink& link) {
                  LightGate::Ruling stop;
                  stop.headline = "Dark: the light lay 3.1 mm beside the plan.";
                  stop.stop = true;
                  link.gate(GateCall::step, {}, 0, &stop);
              }),
              "Dark: the light lay 3.1 mm beside the plan. ");
    EXPECT_EQ(last_word([&](SessionLink& link) {
                  link.refused(SessionCall::update, CheckFailedError("x", "Do it again."));
                  look(link);
              }),
              "The light was put out.");
}

TEST(SessionLink, NamesAreSaidWhereTheSiteSaysSoAndElseLeftOut) {
    Case the_case;
    the_case.names.title = "Erika Mustermann, frontal defect";
    the_case.names.patient = "Erika";
    const auto named = heard_of(the_case, true);
    EXPECT_TRUE(says(named, "Case", "Erika"));
    EXPECT_TRUE(says(named, "Gate", "Erika"));
    const auto unnamed = heard_of(the_case, false);
    EXPECT_TRUE(says(unnamed, "Gate", "is not measured"));
    for (const ReceivedMessage& message : unnamed)
        EXPECT_EQ(message.text.find("Erika"), std::string::npos) << message.device << ": " << message.text;
}

TEST(SessionLink, ASessionThatSaysNothingMoreIsCalledStale) {
    Case the_case;
    SessionLinkSettings settings;
    settings.server.port = 0;
    settings.alive_every = std::chrono::milliseconds(20);
    settings.stale_after = std::chrono::milliseconds(60);
    auto link = std::make_unique<SessionLink>(the_case, settings);
    test::IgtlReceiver receiver(link->port());
    LightGate::Ruling ruling;
    ruling.trust = LightTrust::aligned;
    ruling.headline = "ALIGNED";
    link->gate(GateCall::step, {}, 0, &ruling);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    link.reset();
    const auto& all = receiver.all();
    const auto is = [](const char* word) {
        return [word](const ReceivedMessage& message) { return message.word == word; };
    };
    const auto aligned = std::find_if(all.begin(), all.end(), is("aligned"));
    const auto stale = std::find_if(all.begin(), all.end(), is("stale"));
    ASSERT_NE(aligned, all.end());
    ASSERT_NE(stale, all.end());
    EXPECT_LT(aligned - all.begin(), stale - all.begin());
    EXPECT_EQ(std::find_if(stale, all.end(), is("aligned")), all.end());
}

}  // namespace
}  // namespace planlight
