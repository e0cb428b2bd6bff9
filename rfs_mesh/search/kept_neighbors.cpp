#include "rfs_mesh/search/kept_neighbors.h"

#include <algorithm>
#include <cmath>

namespace rfsmooth::rfs_mesh {

void KeptNeighbors::nearest(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
                            std::vector<Neighbor>& out) {
  if (find(index, place, m, out)) return;
  // Who asks for more than before will do so again.
  const std::size_t wanted = !kept_.empty() && kept_.size() < m ? 2 * m : m;
  index.nearest(place, int(std::max(wanted, most_)), out);
  kept_.resize(out.size());
  std::transform(out.begin(), out.end(), kept_.begin(), [](const Neighbor& q) { return q.index; });
  at_ = place;
  out.resize(std::min(m, out.size()));
}

/// The first m of the kept, with their distances from `place`.
void KeptNeighbors::seen_from(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
                              std::vector<Neighbor>& out) const {
  out.clear();
  for (std::size_t k = 0; k < std::min(m, kept_.size()); ++k)
    out.push_back({kept_[k], squared_distance(index.points()[kept_[k]], place)});
}

/// False if a nearer point may not be among the kept.
bool KeptNeighbors::find(const SpatialIndex& index, const Eigen::Vector3d& place, std::size_t m,
                         std::vector<Neighbor>& out) const {
  if (kept_.size() < m) return false;
  if (place == at_) {
    seen_from(index, place, m, out);
    return true;
  }
  seen_from(index, place, 2 * m, out);
  // Who is not looked at is at least as far from where the place was as the last who is.
  constexpr double kRounding = 1 - 1e-9;
  const double sure =
      kRounding * std::sqrt(squared_distance(index.points()[out.back().index], at_)) - (place - at_).norm();
  const auto last = std::ptrdiff_t(m - 1);
  std::nth_element(out.begin(), out.begin() + last, out.end());
  if (!(std::sqrt(out[std::size_t(last)].squared_distance) < sure)) return false;
  out.resize(m);
  sort_neighbors(out);
  return true;
}

}  // namespace rfsmooth::rfs_mesh
