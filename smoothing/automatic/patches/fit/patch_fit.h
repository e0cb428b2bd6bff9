/// One patch: a seed point, its m nearest guide points and the quadric z = c0 + c1 u + ... + c5 v^2 fitted to
/// their heights above the seed's tangent plane, with weights (1 - d^2/r^2)^2 and the cosine squared between
/// normals. Points on the two sides of an edge take part in different patches; a patch that bridges one has
/// residuals above the noise and says less wherever another covers the point:
///
///     say = v / (v + max(0, excess)),  v = 6 / N,  N = (sum w)^2 / sum w^2, the effective number of points,
///     excess = (RSS / sigma^2 - (sum w - tr(A^-1 B))) / sum w - sqrt(2 / N),
///     A = sum w f f^T,  B = sum w^2 f f^T,  f = (1, u, v, u^2, u v, v^2)
///
/// The excess is by how much the residuals' variance is above that of the noise, in sigma^2, beyond one
/// standard deviation of chance.
///
/// Members along a line, as on a laser's ring, get the parabola over u alone; it says as much as a quadric
/// does.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "rfs_mesh/search/wide_neighbors.h"
#include "smoothing/automatic/guide/height_field.h"
#include "smoothing/automatic/patches/patch_members.h"

namespace rfsmooth::smoothing {

/// Fits one patch after another; what it found stands until the next. One object per thread. The same patches
/// in the same order give the same bits.
class PatchFit {
 public:
  /// \param members 1 to the number of points. Keeps a reference to `field`.
  PatchFit(const HeightField& field, std::size_t members);

  /// \param sigma of the noise, world units, > 0. O(log n + members).
  void fit(Index seed, double sigma);

  std::size_t size() const { return size_; }  ///< members whose weight is not 0
  const Index* point() const { return point_.data(); }
  const MemberWeight* weight() const { return weight_.data(); }  ///< (1 - d^2/r^2)^2 cos^2 of each
  /// What it says of their heights, world units, each along the point's own normal over the guide.
  const float* height() const { return said_.data(); }
  /// f^T A^-1 f of each: times weight / kMemberUnit the share of the point's own height in that.
  const float* own() const { return own_.data(); }

  float say() const { return say_; }         ///< 0 to 1; 0 if size() is 0
  bool several() const { return several_; }  ///< whether the excess shows more than one sheet

 private:
  Eigen::Vector3d axis_at(Index seed) const;
  void gather(Index seed, double sigma);

  const HeightField& field_;
  std::size_t members_, size_ = 0;
  rfs_mesh::WideNeighbors near_;
  double radius_ = 0;             ///< world units
  double sum_ = 0, squares_ = 0;  ///< of the weights
  std::vector<Index> point_;
  std::vector<MemberWeight> weight_;
  /// Of the members, in radii: the frame's u and v, the guide over the tangent plane, the data over that.
  std::vector<float> u_, v_, guide_, data_;
  std::vector<float> exact_weight_, cosine_, said_, own_;
  float say_ = 0;
  bool several_ = false;
};

}  // namespace rfsmooth::smoothing
