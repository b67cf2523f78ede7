#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace planlight::simulation {

/// What a surface is of, for its look.
enum class Material : std::uint8_t { none, skin, paper, ink, blood, cloth, glove, plastic, metal, hair };

/// What stands in front of the rig, in its own frame (`ct` for a head, `board` for a board; below always called ct).
class Surface {
public:
    virtual ~Surface() = default;

    struct Hit {
        Eigen::Vector3d p_in_ct, normal_in_ct;
        double distance_mm = 0;
        Material made_of = Material::none;  ///< of a thing that lies on the object; none: the object itself
    };
    /// The first skin along a ray (`direction` of unit length).
    virtual std::optional<Hit> first_hit(const Eigen::Vector3d& origin_in_ct,
                                         const Eigen::Vector3d& direction) const = 0;

    /// True when the object lies between a point of it (moved off the surface by a little) and a light.
    virtual bool in_shadow(const Eigen::Vector3d& p_in_ct, const Eigen::Vector3d& normal_in_ct,
                           const Eigen::Vector3d& light_in_ct) const = 0;

    virtual Eigen::Vector3d low_in_ct() const = 0;
    virtual Eigen::Vector3d high_in_ct() const = 0;
    /// Middle of the box round the object.
    Eigen::Vector3d middle_in_ct() const { return (low_in_ct() + high_in_ct()) / 2; }
};

/// How a point of the object reflects.
struct Look {
    Material material = Material::skin;
    double albedo = 0;       ///< diffuse
    double specular = 0;     ///< strength of the highlight
    double translucent = 0;  ///< share of the light that leaves beside where it fell
};

/// How the points of a surface reflect.
class SurfaceLook {
public:
    virtual ~SurfaceLook() = default;
    virtual Look at(const Eigen::Vector3d& p_in_ct) const = 0;
};

}  // namespace planlight::simulation
