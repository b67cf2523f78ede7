#pragma once

#include <cstddef>
#include <cstdint>

// The inner loops of the matching: plain arrays, single precision, as wide as the processor allows.
namespace planlight::match_kernels {

/// A signed distance field as plain values, i running fastest.
struct Field {
    const float* mm;
    int stride_y, stride_z;     ///< values from row to row, from slab to slab
    float end_x, end_y, end_z;  ///< the last node of each axis; points must lie before it
    float per_mm;               ///< nodes per mm
};

/// Where the points go: node = per_mm * (R p + shift), in field nodes; arm = R p + arm_shift (mm).
struct Placing {
    float R[9];          ///< row by row
    float shift[3];      ///< mm, from the field's first node
    float arm_shift[3];  ///< mm, from the centre about which the step turns
};

/// How much a point counts by its distance from the skin.
struct Gate {
    float scale_inside_mm, scale_outside_mm;  ///< of Tukey's biweight
    float max_mm;                             ///< farther than this from the skin a point takes no part
};

/// Adds the normal equations of point to plane: `sums` are the upper triangle of H, row by row, then g (27 numbers).
/// `skip` may be null; a point with skip[i] != 0 takes no part. Returns how many points took part.
std::size_t add_point_to_plane(const float* x, const float* y, const float* z, const std::uint8_t* skip, std::size_t n,
                               const Field& field, const Placing& placing, const Gate& gate, double* sums);

/// Sum of the truncated distances: at most `inside_mm` in the body, `outside_mm` outside of it, `beyond_mm` beyond the
/// field and `inside_mm` where the normal (nx, ny, nz; turned by R) does not face as the skin does.
double sum_failure(const float* x, const float* y, const float* z, const float* nx, const float* ny, const float* nz,
                   std::size_t n, const Field& field, const Placing& placing, float inside_mm, float outside_mm,
                   float beyond_mm);

/// What a pair of sites must look like, and how exactly.
struct PairGate {
    float length_mm, first, second, between;
    float length_tolerance_mm, cosine_tolerance;
};

/// Marks (1 or 0) which of `n` pairs do.
void mark_alike(const float* length_mm, const float* first, const float* second, const float* between, std::size_t n,
                const PairGate& wanted, std::uint8_t* marks);

}  // namespace planlight::match_kernels
