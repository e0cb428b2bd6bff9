/// The points around one, as columns of numbers that a processor works through eight at a time.
///
/// Neighbours in Morton order have nearly the same surroundings: those of one, taken a little wider, serve
/// the next ones, too, and the tree is searched once for several.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/guide/height_field.h"

namespace rfsmooth::smoothing {

/// What neighbours need to know of a point. Data and place are relative to the guide's, world units.
struct Packed {
  Eigen::Vector3f data, place, normal;
  float residual;  ///< in s, clipped
};

/// The surroundings of one point after the other. For one thread; the arguments outlive it.
class Surroundings {
 public:
  static constexpr std::size_t kLanes = 8;
  static constexpr std::size_t kMost = 8192;
  using Column = std::vector<float>;

  Surroundings(const HeightField& field, const std::vector<Packed>& packed)
      : field_(field), packed_(packed) {}

  /// Takes what is within `radius` of `centre`, world units, and more; at most kMost points, evenly over the
  /// tree.
  void move_to(const Eigen::Vector3d& centre, double radius);

  /// A multiple of kLanes; the last ones may stand for no point and are far away.
  std::size_t size() const { return residual.size(); }
  /// One in so many of the points within the radius is here: in dense places a part of them says as much.
  std::size_t stride() const { return stride_; }
  /// Where the guides are counted from.
  const Eigen::Vector3d& origin() const { return centre_; }

  std::array<Column, 3> guide, data, place, normal;  ///< data and place from the guide
  Column residual;

 private:
  const HeightField& field_;
  const std::vector<Packed>& packed_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double reach_ = -1;
  std::size_t stride_ = 1;
  std::vector<rfs_mesh::Neighbor> near_;
};

}  // namespace rfsmooth::smoothing
