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
/// Source: aggregation of overlapping local estimates as in image denoising (Katkovnik et al. 2010, "From
/// local kernel to nonlocal multiple-model image denoising", section 6); the constants are ours.
#pragma once

#include <array>
#include <vector>

#include "rfsmooth/smoothing/height_field.h"

namespace rfsmooth::smoothing {

/// What the patches say of every point.
struct Prediction {
  std::vector<double> height;  ///< n, along the point's own normal over the guide
  std::vector<double> own;     ///< n: d height_i / d z_i, the share of the point's own height
  std::vector<char> covered;   ///< n: whether any patch reaches the point
};

/// Overlapping quadrics over one number of points.
class Patches {
 public:
  /// Patches of `members` points each (at most the number of points) around the points `seeds`, evenly
  /// spread; eight patches over a point are good (16 gain 2 % of the error at twice the time). Places that
  /// they leave uncovered get seeds of their own. \param sigma n: the noise at each point, world units, > 0.
  /// It only weighs patches against each other. O(n log n); memory about 300 bytes a point at 16 members,
  /// less at more.
  Patches(const HeightField& field, std::size_t members, std::vector<Index> seeds,
          const std::vector<double>& sigma, const Context& context);

  Prediction predict(const Context& context) const;

  /// Averages over patches of the patches' averages: a mean over about twice `members` points. O(n).
  std::vector<double> mean(const std::vector<double>& values, const Context& context) const;

 private:
  /// One fitted quadric. inverse: of the normal equations, lower triangle by rows.
  struct Patch {
    Eigen::Vector3d centre, axis, u, v;
    double square = 0;  ///< radius squared
    double weight = 0;
    std::array<float, 6> quadric = {};
    std::array<float, 21> inverse = {};
  };
  using Features = Eigen::Matrix<double, 6, 1>;
  static Features features(const Patch& patch, const Eigen::Vector3d& from_centre);

  void fit(std::size_t first, std::size_t last, const std::vector<double>& sigma, const Context& context);
  void fit_one(std::size_t s, const std::vector<double>& sigma, std::vector<rfs_mesh::Neighbor>& near);
  void cover(const std::vector<Index>& points, const Context& context);
  std::vector<Index> uncovered() const;

  const HeightField& field_;
  std::size_t members_ = 0, reach_ = 0;
  std::vector<Index> seeds_;
  std::vector<Patch> patches_;
  std::vector<Index> member_;         ///< patches x members
  std::vector<float> member_weight_;  ///< of each; 0 for points of another sheet
  std::vector<Index> over_;           ///< n x reach: the nearest patches of each point
  std::vector<float> over_weight_;    ///< (1 - d^2/r^2)^2 cos^2 of each; 0 where the patch does not reach
};

}  // namespace rfsmooth::smoothing
