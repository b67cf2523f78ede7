#pragma once

#include "registration/matching/point_pairs.h"
#include "registration/matching/register_patient.h"

namespace planlight {

/// A scan and landmarks together.
///
/// The scan is matched without help, and the landmarks check that match: one that is off lowers its verdict. Only where
/// the scan alone is refused, or was not sure and the landmarks refuse it, do they help: they give the start, the fine
/// match lays the scan on the skin near it, and they check that it stayed there. Such a match is at best `ask`. A sure
/// match that the landmarks contradict stays refused: one of the two is wrong. A scan that does not lie on the skin
/// there either is refused, and so are landmarks that do not fit each other. No landmarks: as `register_patient`.
RegistrationResult register_with_landmarks(const PointCloud& cloud, const SkinLut& lut,
                                           const std::vector<PointPair>& pairs,
                                           const RegistrationSettings& settings = {},
                                           const PointPairSettings& pair_settings = {});

}  // namespace planlight
