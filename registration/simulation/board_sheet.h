#pragma once

#include "planning_io/types/image.h"
#include "registration/simulation/surface.h"

namespace planlight::simulation {

/// A printed sheet as it lies before the rig. Its frame: origin at the print's top left corner, x right, y down, z into
/// the sheet, mm. It may be bent: a cylinder of any direction, `sag_mm` deep over the print's diagonal.
struct BoardSheet {
    GrayImage print;  ///< what the printer was given: 255 white paper, darker where there is ink
    double px_per_mm = 10;
    double margin_mm = 15;      ///< white round the print
    double sag_mm = 0;          ///< height of the middle above the corners that lie across the cylinder
    double bend_direction = 0;  ///< radians, of the axis along which it is bent

    double width_mm() const { return print.width / px_per_mm; }
    double height_mm() const { return print.height / px_per_mm; }
    /// Height of the sheet, mm along z, and its slope there.
    double z_at(double x, double y, Eigen::Vector2d* slope = nullptr) const;
};

/// White paper without a print, 210 x 297 mm.
BoardSheet white_card();

/// The sheet as a surface: rays meet it by Newton's method on its height.
class SheetSurface final : public Surface {
public:
    explicit SheetSurface(const BoardSheet& sheet) : sheet_(sheet) {}
    std::optional<Hit> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const override;
    bool in_shadow(const Eigen::Vector3d&, const Eigen::Vector3d&, const Eigen::Vector3d&) const override {
        return false;
    }
    Eigen::Vector3d low_in_ct() const override;
    Eigen::Vector3d high_in_ct() const override;

private:
    const BoardSheet& sheet_;
};

/// Matte paper with ink on it.
class SheetLook final : public SurfaceLook {
public:
    static constexpr double kPaperAlbedo = 0.85;
    explicit SheetLook(const BoardSheet& sheet) : sheet_(sheet) {}
    Look at(const Eigen::Vector3d& p) const override;

private:
    const BoardSheet& sheet_;
};

}  // namespace planlight::simulation
