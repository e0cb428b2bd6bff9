/// The nearest points of a place that is searched again and again, while it moves a little or not at all:
/// found among those of the search before, as far as these surely hold them.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// What was found around one place: 4 bytes a point. Not for several threads at once.
class KeptNeighbors {
 public:
  /// \param most points to keep: twice as many as will be asked for after the place has moved. Where more are
  /// asked for than before, twice as many are kept.
  explicit KeptNeighbors(std::size_t most) : most_(most) {}

  /// The same as index.nearest(place, m, out), 1 <= m <= n; always of the same index.
  void nearest(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
               std::vector<Neighbor>& out);

 private:
  bool find(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
            std::vector<Neighbor>& out) const;
  void seen_from(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
                 std::vector<Neighbor>& out) const;

  std::size_t most_;
  Eigen::Vector3d at_ = Eigen::Vector3d::Zero();
  std::vector<Index> kept_;  ///< the nearest of at_, ascending
};

}  // namespace rfsmooth::rfs_mesh
