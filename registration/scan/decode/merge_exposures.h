#pragma once

#include <span>

#include "registration/scan/scan_surface.h"

namespace planlight {

/// Adds what another exposure of the same camera in the same pose knows: per pixel the code with the lesser sigma is
/// kept, so a pixel that saturates takes the darker exposure and a dark one the brighter. Of the pixels that no
/// exposure decodes the counts by reason are those of the exposure with the fewest. Throws std::invalid_argument when
/// sizes or directions differ, CheckFailedError where the codes that both know differ by more than their noise and a
/// tenth of a projector pixel (median; of all, or of more than a tenth of the small parts of the picture): the patient
/// moved between them.
void take_better(DecodedView& view, const DecodedView& other);

/// A scan from several captures of the same pose at different exposures or brightnesses, at least one. Each must be
/// whole.
ScanResult scan_from_exposures(std::span<const ScanCapture> captures, const RigCalibration& rig,
                               const ScanSettings& settings = {});

/// Which exposure of a pixel is taken.
struct ExposureSettings {
    double max_saturated = 0.01;  ///< share of the lit pixels of either camera above which a darker capture follows
    int most = 3;                 ///< captures
    double darker = 0.6;  ///< brightness of the next white by this one's: about a third of the light at a gamma of 2.2
};

/// Adds captures with a darker and darker white while skin saturates in the last one. Throws as `capture_scan`.
void add_darker_captures(Projector& projector, StereoCamera& cameras, const Clock& clock,
                         std::vector<ScanCapture>& captures, const std::function<void(int, int)>& progress = {},
                         const ExposureSettings& settings = {});

}  // namespace planlight
