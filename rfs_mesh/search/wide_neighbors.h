/// The k nearest points of a place for k in the tens and hundreds, unsorted and by axis, as fits read them.
///
/// The search radius is guessed from the previous place, which is near, and checked by counting. Of the
/// points within the guess a histogram of their distances picks the k nearest; only those in its last bin are
/// compared with each other. Two to four times as fast as SpatialIndex::nearest, which sorts.
///
/// Distances are compared in single precision: of points equally far up to 1e-7 the one of the lower index is
/// taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The search and its answer. One object per thread. The same places in the same order give the same answers.
class WideNeighbors {
 public:
  /// \param k at most the number of points of `index`, else all are found. Keeps a reference to `index`.
  WideNeighbors(const SpatialIndex& index, std::size_t k);

  /// Finds the k nearest of `place`, a point at the place included. O(log n + k).
  void find(const Eigen::Vector3d& place);
  /// The same with another k from now on.
  void find(const Eigen::Vector3d& place, std::size_t k);

  std::size_t size() const { return kept_; }
  double unit() const { return unit_; }  ///< of the lengths below, world units, > 0
  const Index* index() const { return id_.data(); }
  const float* x() const { return x_.data(); }  ///< offset from the place
  const float* y() const { return y_.data(); }
  const float* z() const { return z_.data(); }
  const float* squared() const { return squared_.data(); }  ///< squared distance
  float farthest() const { return farthest_; }              ///< largest squared distance

 private:
  struct Item {
    float squared, x, y, z;
    Index id;
  };
  std::size_t gather(const Eigen::Vector3d& place, double squared_bound);
  void select();
  void make_room(std::size_t size);

  const SpatialIndex& index_;
  std::size_t k_, kept_ = 0;
  double guess_ = 0, unit_ = 1;
  float farthest_ = 0;
  std::vector<float> squared_, x_, y_, z_;
  std::vector<Index> id_;
  std::vector<std::uint8_t> bin_;
  std::vector<Item> last_bin_;
  std::vector<Neighbor> first_;
};

}  // namespace rfsmooth::rfs_mesh
