#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "registration/simulation/surface.h"

namespace planlight::simulation {

/// What else is in the room beside the head. Each is drawn anew for every seed.
struct ThingsSettings {
    bool drape_behind = false;  ///< a sheet on the table, 60 to 80 mm behind the nearest skin, with low folds
    bool drape_hole = false;    ///< a sheet with a hole, laid over the head: it falls until it rests
    double hole_mm = 130;       ///< width of the hole
    bool hair = false;          ///< over the crown to the forehead and the temples, 3 to 12 mm thick, in strands
    bool hand = false;          ///< a gloved hand with its forearm, reaching in over the skin
    bool tube = false;          ///< from the face to the rim of the picture
    bool retractor = false;     ///< two blades of metal over the rim of the field
    bool any() const { return drape_behind || drape_hole || hair || hand || tube || retractor; }
};

/// Triangles in ct, each made of something.
struct ThingsMesh {
    std::vector<Eigen::Vector3f> vertices_in_ct;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Material> made_of;  ///< per triangle
    void add(const ThingsMesh& part);
};

/// Lays the things round and over the skin at `middle_in_ct`, as seen from `eye_in_ct` (the projector); gravity goes
/// away from it.
ThingsMesh lay_things(const Surface& skin, const Eigen::Vector3d& middle_in_ct, const Eigen::Vector3d& eye_in_ct,
                      const ThingsSettings& settings, std::mt19937& random);

/// How cloth, gloves, plastic, metal and hair reflect at a place.
Look look_of(Material made_of, const Eigen::Vector3d& p_in_ct);

}  // namespace planlight::simulation
