#include "rfs_mesh/search/kept_neighbors.h"

#include <algorithm>
#include <cmath>

namespace rfsmooth::rfs_mesh {

void KeptNeighbors::nearest(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
                            std::vector<Neighbor>& out) {
  if (find(index, place, m, out)) return;
  // Who asks for more than before will do so again.
  const std::size_t wanted = !kept_.empty() && kept_.size() < m ? 2 * m : m;
  index.nearest(place, int(std::max(wanted, most_)), kept_);
  at_ = place;
  out.assign(kept_.begin(), kept_.begin() + std::ptrdiff_t(std::min(m, kept_.size())));
}

/// False if a nearer point may not be among the kept.
bool KeptNeighbors::find(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
                         std::vector<Neighbor>& out) const {
  if (kept_.size() < m) return false;
  const auto last = std::ptrdiff_t(m - 1);
  if (place == at_) {
    out.assign(kept_.begin(), kept_.begin() + last + 1);
    return true;
  }
  out.assign(kept_.begin(), kept_.begin() + std::ptrdiff_t(std::min(kept_.size(), 2 * m)));
  // Who is not looked at is at least as far from where the place was as the last who is.
  constexpr double kRounding = 1 - 1e-9;
  const double sure = kRounding * std::sqrt(out.back().squared_distance) - (place - at_).norm();
  for (Neighbor& q : out) q.squared_distance = squared_distance(index.points()[q.index], place);
  std::nth_element(out.begin(), out.begin() + last, out.end());
  if (!(std::sqrt(out[std::size_t(last)].squared_distance) < sure)) return false;
  out.resize(m);
  sort_neighbors(out);
  return true;
}

}  // namespace rfsmooth::rfs_mesh
