#pragma once

#include "app/windows/operator_model.h"

namespace planlight {

/// The word of a status: "ALIGNED".
const char* status_word(StatusKind kind);

}  // namespace planlight
