#pragma once

#include <cstddef>
#include <optional>

#include "app/session.h"
#include "app/windows/operator_model.h"
#include "projection/light_gate.h"

namespace planlight {

/// What the banner says of one update, as the gate ruled. `card_asked`: a card with the patient's name is to be lit
/// until the light is verified.
Status status_of(const Session& session, const Session::Update& update, const LightGate::Ruling& ruling,
                 bool card_asked);

/// How far off an item's light was seen, mm; as far as all of it where that was found as one. Empty where the cameras
/// told too little of it.
std::optional<double> item_off_mm(const LightCheck& light, std::size_t i);

}  // namespace planlight
