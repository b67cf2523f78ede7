#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

namespace planlight {

/// Where the patient's skin lies now, against the CT's: how far it was found along the CT skin's outward normal, mm,
/// positive outside. Another threshold, swelling, skin that sank: the match takes it out of the pose, the drawing puts
/// it back.
struct SkinDisplacement {
    /// What the scan found at one place.
    struct Place {
        Eigen::Vector3d p_in_ct = Eigen::Vector3d::Zero();  ///< on the CT's skin
        double mm = 0;
        double sigma_mm = 0;  ///< one standard deviation of `mm`
    };
    /// A place on the CT's skin over which the scan saw a surface that was not taken for skin.
    struct Cover {
        Eigen::Vector3d p_in_ct = Eigen::Vector3d::Zero();
        double mm = 0;  ///< how far outside
    };
    std::vector<Cover> covered;  ///< about `apart_mm` apart; of a swelling there is a place as well
    std::vector<Place> places;   ///< about `apart_mm` apart over the scanned skin; empty: nothing is known of the skin
    double apart_mm = 0;
    double offset_mm = 0;      ///< median of the places: taken where the scan saw no skin
    double spread_mm = 0;      ///< of the places about the offset, one standard deviation
    double alike_over_mm = 0;  ///< the displacement is alike over this length (correlation exp(-distance / length))
    bool known() const { return !places.empty(); }
};

/// How far outside the CT's skin the scan saw a surface over this point that was not taken for skin, mm; empty where
/// there is none, or skin was found nearer to it.
std::optional<double> covered_by_mm(const SkinDisplacement& displacement, const Eigen::Vector3d& p_in_ct);

/// What of the spread is the skin's: without the noise of the scan, which is in each place's sigma. 0 when all may be
/// noise.
double spread_of_skin_mm(const SkinDisplacement& displacement);

/// The displacement at any point: the posterior mean of a Gaussian process with the offset as its mean and an
/// exponential covariance, from the places round the point (local kriging: Cressie 1993, 3.2). Off the scan it goes
/// back to the offset, and its sigma up to the spread.
class SkinDisplacementField {
public:
    /// Throws std::invalid_argument when a number of it is not finite, or a length or sigma not positive.
    explicit SkinDisplacementField(SkinDisplacement displacement);
    ~SkinDisplacementField();
    SkinDisplacementField(SkinDisplacementField&&) noexcept;
    SkinDisplacementField& operator=(SkinDisplacementField&&) noexcept;

    struct Value {
        double mm = 0;
        double sigma_mm = 0;   ///< one standard deviation, as far as the scanned skin tells; 0 when nothing is known
        bool scanned = false;  ///< the scan saw the skin within two `apart_mm`
    };
    Value at(const Eigen::Vector3d& p_in_ct) const;
    const SkinDisplacement& displacement() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace planlight
