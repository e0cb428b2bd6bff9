/// Overlapping local quadrics over a height field: at every point several predict its height, and their
/// average is a smoother with a known share of the point's own value in it.
///
/// A patch is a seed point, its m nearest guide points and the quadric z = c0 + c1 u + ... + c5 v^2 fitted to
/// their heights above the seed's tangent plane, with weights (1 - d^2/r^2)^2 and the cosine squared between
/// normals. Points on the two sides of an edge take part in different patches; a patch that bridges one has
/// residuals above the noise and weighs less wherever another covers the point:
///
///     weight = v / (v + max(0, excess)),  excess = RSS / sigma^2 - degrees of freedom per unit of weight,
///                                          v = 6 / (effective number of points)
///
/// Members along a line, as on a laser's ring, get the parabola over u alone; it weighs as a quadric does.
///
/// Source: aggregation of overlapping local estimates as in image denoising (Katkovnik et al. 2010, "From
/// local kernel to nonlocal multiple-model image denoising", section 6); the constants are ours.
/// Const functions are thread safe; a Memory belongs to one Patches at a time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/raw_array.h"
#include "rfs_mesh/search/wide_neighbors.h"
#include "smoothing/automatic/patches/height_field.h"

namespace rfsmooth::smoothing {

/// What the patches say of every point.
struct Prediction {
  std::vector<float> height;  ///< n, along the point's own normal over the guide
  std::vector<float> own;     ///< n: d height_i / d z_i, the share of the point's own height
  std::vector<char> covered;  ///< n: whether any patch reaches the point
};

/// The share of a point's noise that stays in a prediction which has the share `own` of its height: that of
/// all who share the noise (automatic.h).
inline float own_of_all(float own, float shared) {
  return own * shared / (1 + own * (shared - 1));
}

/// Overlapping quadrics over one number of points.
class Patches {
  // What Memory holds.
  /// One fitted quadric, over u and v in radii, laid out for sums over four numbers at a time: the
  /// coefficient of u^p v^q of a polynomial is number 4 q + p.
  struct Patch {
    Eigen::Vector3d centre;
    float radius, weight;
    bool several;                   ///< whether its points seem to lie on several sheets
    std::array<float, 12> frame;    ///< of x, y, z each: its parts along u, v (in radii) and the axis
    std::array<float, 12> quadric;  ///< the height, in radii
    std::array<float, 20> spread;   ///< f^T A^-1 f, A the normal equations, but for
    float spread_u4;                ///< the coefficient of u^4
  };

  /// Weights of members in 1/65535.
  using Weight = std::uint16_t;

 public:
  /// What patches are kept in; to be used again for the next ones, since the system takes longer to give out
  /// so much memory than a pass over it takes.
  class Memory {
    friend class Patches;
    RawArray<Patch> patches_;
    std::vector<Index> start_;        ///< patches + 1: where each one's members begin
    RawArray<Index> member_;          ///< of all patches, those of another sheet left out
    RawArray<Weight> member_weight_;  ///< (1 - d^2/r^2)^2 cos^2 of each, not 0
    std::vector<Index> over_start_;   ///< n + 1
    RawArray<Index> over_;            ///< of each point: the patches over it, ascending, weight not 0
    RawArray<Weight> over_weight_;    ///< the point's weight in each
  };

  /// Patches of `members` points each (at most the number of points) around the points `seeds`, evenly
  /// spread; eight patches over a point are good (16 gain 2 % of the error at twice the time). Places that
  /// they leave uncovered get seeds of their own. \param sigma n: the noise, world units, > 0. It only
  /// weighs patches against each other. `memory` outlives them. O(n log n); memory about 12 bytes a point and
  /// patch over it, and 220 bytes a patch. \throw std::length_error for 2^32 members in all.
  Patches(const HeightField& field, std::size_t members, std::vector<Index> seeds,
          const std::vector<double>& sigma, Memory& memory, const Context& context);

  Prediction predict(const Context& context) const;

  /// Seeds, ascending, of the patches that see more than one sheet: residuals that vary by more than the
  /// noise.
  std::vector<Index> with_several_sheets() const;

  /// Averages over patches of the patches' averages: a mean over about twice `members` points. O(n).
  std::vector<float> mean(const std::vector<float>& values, const Context& context) const;

 private:
  struct Workspace;
  struct Covering;

  void fit(std::size_t first, std::size_t last, const std::vector<double>& sigma, const Context& context);
  /// Of the members of a patch: its radius and sums of their weights.
  struct Members {
    double radius = 0;            ///< world units
    double sum = 0, squares = 0;  ///< of the weights
    std::size_t kept = 0;         ///< how many have one
  };
  /// Enters the members whose weight is not 0 from `member` and `weight` on; returns how many.
  std::size_t fit_one(std::size_t s, double sigma, Workspace& work, Index* member, Weight* weight);
  Eigen::Vector3d axis_at(Index seed) const;  ///< the mean normal about it, unit
  /// The members of patch s, and its frame.
  Members gather(std::size_t s, double sigma, Workspace& work, Index* member, Weight* weight);
  void cover_missing(const std::vector<double>& sigma, Covering& covering, const Context& context);
  void count(std::size_t first, std::size_t last, Covering& covering, const Context& context);
  void transpose(const Covering& covering, const Context& context);

  const HeightField& field_;
  std::size_t members_ = 0;
  std::vector<Index> seeds_;
  Memory& memory_;
};

}  // namespace rfsmooth::smoothing
