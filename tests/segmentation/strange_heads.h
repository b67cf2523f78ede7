#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "planning_io/types/triangle_mesh.h"
#include "planning_io/types/volume.h"
#include "segmentation/segment_skin.h"
#include "tests/segmentation/mr_like.h"

namespace planlight::test {

/// What must become of a head, once it is made an MR of.
enum class Fate {
    right,    ///< taken, with the skin where it is
    said,     ///< taken with a doubt, or refused
    quiet,    ///< right, and without a word
    not_bad,  ///< taken rightly, or with a doubt, or refused: all but a wrong skin without a word
    refused,
};

/// A CT that was made strange: what lies on the head, is missing from it, or its size.
struct StrangeHead {
    Volume ct;
    SkinMask body;      ///< what shows in an MR of it
    TriangleMesh skin;  ///< the true skin
};

struct StrangeCase {
    std::string name;
    Fate fate = Fate::right;
    std::function<StrangeHead()> make;
    double coil = 0;                                    ///< brightest to darkest place along the head; 0: as drawn
    std::optional<MrContrast> contrast = std::nullopt;  ///< else the seed's
    bool only_mr = false, only_ct = false;
    bool sharp = false;                       ///< a CT that shows what was drawn as it was drawn
    std::function<void(Volume&)> spoil = {};  ///< what becomes of the volume afterwards; or empty
};

/// Of a head in HU with its body and skin (which must outlive the cases): children, hair with gel, electrodes,
/// cushions, bandages, blankets, head phones, masks, coils on one side, a flap of bone that is out, a mouth full of
/// metal, heads that lie askew, rare contrasts, metal in a CT, even covers, volumes that were spoilt (cut greys, a
/// patient who moved), and what is no head.
std::vector<StrangeCase> strange_heads_of(const Volume& ct, const SkinMask& body, const TriangleMesh& skin);

}  // namespace planlight::test
