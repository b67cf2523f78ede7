#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/session_observer.h"

// What a session was asked and what came of it, each as one line of JSON (FORMATS.md of planning_io/recording). The
// same session, asked the same, gives the same lines to the last digit: no wall clock is in what came of it.
namespace planlight::session_events {

std::string asked(SessionCall call, const std::vector<PointPair>& landmarks, int which);
std::string scanned(const Session& session);
std::string matched(const Session& session);
std::string updated(const Session& session, const Session::Update& update);
std::string skin_checked(const SkinCheck& check);
std::string resumed(const Session& session, const ResumeCheck& check);
std::string refused(SessionCall call, const std::exception& why);
std::string gate(GateCall call, Instant at, double off_mm, const LightGate::Ruling* ruling);
/// Of the gate's event of a check of the skin; infinite where the skin lies elsewhere, nobody can say by how much.
double skin_off_mm(const nlohmann::ordered_json& event);
std::string pressed(const std::string& action);
std::string said(const std::string& kind, const std::string& headline, const std::vector<std::string>& details);
std::string room(const RoomFacts& room);
/// Of the event that `room` wrote; a program before this one wrote a recorded room as a simulated one.
RoomKind room_kind_of(const nlohmann::ordered_json& room);

/// Of `updated`: what was left alone. "lit", and "dark" with its reason.
const char* word_of(LightTrust trust);
const char* word_of(LightFault fault);

/// The name of a call in the events, and back; `from_word` gives false for a word that is none.
const char* word_of(SessionCall call);
const char* word_of(GateCall call);
bool from_word(const std::string& word, SessionCall& call);
bool from_word(const std::string& word, GateCall& call);

}  // namespace planlight::session_events
