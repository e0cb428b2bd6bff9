#include "smoothing/automatic/guide/stranded.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "rfs_mesh/fit/principal_axes.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/guide/height_field.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kTenth = 9;  // the neighbour whose distance measures density, as does that of the last
constexpr float kThin = 1.7F;      // times the usual: 1.4 takes points at edges, 2 leaves small islands
constexpr int kStrandedRounds = 2;

using rfs_mesh::kNeighbourhood;
using rfs_mesh::Neighbor;
using rfs_mesh::NeighborTable;

/// The guide while points of it are moved: an index of where it was, one of those that are still there, and a
/// small one of the moved points.
class MovingGuide {
 public:
  MovingGuide(const Positions& guide, const Context& context)
      : before_(guide), index_(before_, context), gone_(guide.size(), 0) {}

  const rfs_mesh::SpatialIndex& before() const { return index_; }

  /// The end of it.
  rfs_mesh::KdTree release_tree() { return index_.release_tree(); }

  /// Takes a point out, or puts it back where it was.
  void set_gone(Index i, bool gone) { gone_[i] = char(gone); }

  /// The points that are gone and have a place again. To be called before points are searched for, since
  /// others were taken out or put back.
  void set_moved(std::vector<Index> moved, const Positions& guide, const Context& context) {
    staying_.reset();  // its memory is used again
    staying_.emplace(index_.without(gone_, context));
    moved_ = std::move(moved);
    places_.clear();
    for (const Index i : moved_) places_.push_back(guide[i]);
    moved_index_.emplace(places_, context);
  }

  /// New rows for the points `moved`, as all points are now. O(n).
  void renew_rows(const std::vector<Index>& moved, const Positions& guide, NeighborTable& near,
                  const Context& context) {
    staying_.reset();
    std::vector<char> wanted(guide.size(), 0);
    for (const Index i : moved) wanted[i] = 1;
    rfs_mesh::SpatialIndex(guide, rfs_mesh::KdTree(index_.tree()), context).renew(near, wanted, context);
  }

  /// Whether point i is where it was.
  bool stays(Index i) const { return gone_[i] == 0; }

  struct Search {
    std::vector<Neighbor> found, moved;
  };

  /// The k nearest of `at`, ascending. \param bound squared distance that at least k are surely within
  const std::vector<Neighbor>& nearest(const Eigen::Vector3d& at, std::size_t k, Search& search,
                                       double bound = std::numeric_limits<double>::infinity()) const {
    staying_->nearest_within(at, int(k), bound, search.found);
    return with_moved(at, k, search, bound);
  }

  /// The same of point i. \param row its nearest before anything moved, if it stays
  const std::vector<Neighbor>& nearest_of(Index i, const Positions& guide, Adjacency::Row row, std::size_t k,
                                          Search& search) const {
    std::vector<Neighbor>& found = search.found;
    found.clear();
    if (stays(i)) {
      found.push_back({i, 0});
      for (auto j = row.begin(); j != row.end() && found.size() < k; ++j)
        if (stays(*j)) found.push_back({*j, rfs_mesh::squared_distance(before_[*j], before_[i])});
    }
    if (found.size() < k) return nearest(guide[i], k, search);
    std::sort(found.begin(), found.end());  // others may be at the same place
    return with_moved(guide[i], k, search, found.back().squared_distance);
  }

  /// The squared distance from `at` to the nearest of `some` that stay; infinite if none does.
  double to_nearest_staying(const Eigen::Vector3d& at, Adjacency::Row some) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Index j : some)
      if (stays(j)) least = std::min(least, rfs_mesh::squared_distance(before_[j], at));
    return least;
  }

 private:
  /// Merges the moved points among the k nearest into those found of the others.
  const std::vector<Neighbor>& with_moved(const Eigen::Vector3d& at, std::size_t k, Search& search,
                                          double bound) const {
    std::vector<Neighbor>& found = search.found;
    moved_index_->nearest_within(at, int(k), found.size() < k ? bound : found.back().squared_distance,
                                 search.moved);
    for (const Neighbor& q : search.moved) found.push_back({moved_[q.index], q.squared_distance});
    if (!search.moved.empty()) std::sort(found.begin(), found.end());
    found.resize(std::min(k, found.size()));
    return found;
  }

  const Positions before_;
  rfs_mesh::SpatialIndex index_;
  std::vector<char> gone_;
  std::vector<Index> moved_;
  Positions places_;
  std::optional<rfs_mesh::SpatialIndex> staying_, moved_index_;  // there from set_moved on
};

std::vector<Index> find_stranded(const Adjacency& rings, const Positions& guide, const NeighborTable& near,
                                 const Context& context) {
  const std::size_t n = guide.size();
  std::vector<char> stranded(n);
  const auto alone = [&](std::size_t i) { return rings.degree(i) == 0; };
  for_each_index(context, n, [&](std::size_t i) {
    if (!alone(i)) return;
    const auto row = near[i];
    stranded[i] = 2 * std::size_t(std::count_if(row.begin(), row.end(), alone)) < row.size();
  });
  using Distances = std::array<float, 2>;  // to the tenth and to the last
  std::vector<Distances> distance(n);
  for_each_index(context, n, [&](std::size_t i) {
    for (std::size_t r = 0; r < 2; ++r)
      distance[i][r] = float((guide[near[i][r == 0 ? kTenth : near[i].size() - 1]] - guide[i]).norm());
  });
  for_each_index(context, n, [&](std::size_t i) {
    // More than kThin times the lower quartile: more than a quarter of the neighbours are below the kThin-th.
    const Distances usual = {distance[i][0] / kThin, distance[i][1] / kThin};
    std::array<std::size_t, 2> below = {};
    for (const Index j : near[i])
      for (std::size_t r = 0; r < 2; ++r) below[r] += std::size_t(distance[j][r] < usual[r]);
    if (std::max(below[0], below[1]) > near[i].size() / 4) stranded[i] = 1;
  });
  std::vector<Index> found;
  for (std::size_t i = 0; i < n; ++i)
    if (stranded[i]) found.push_back(Index(i));
  return found;
}

/// p projected onto the plane through the points `near` of some place, ascending.
Eigen::Vector3d project(const Positions& guide, const std::vector<Neighbor>& near, const Eigen::Vector3d& p) {
  const double square = rfs_mesh::kJustBeyond * near.back().squared_distance;
  const auto weight = [square](const Neighbor& q) {
    return square > 0 ? 1 - q.squared_distance / square : 1;
  };
  const auto [centre, axes] = rfs_mesh::principal_axes(guide, near, weight);
  const Eigen::Vector3d normal = axes.vectors.col(0);
  return p - normal * normal.dot(p - centre);
}

/// Lands the points `stranded`; returns which found a place. The others stay.
std::vector<Index> land(const Positions& points, const std::vector<Index>& stranded,
                        const std::vector<double>& most, const NeighborTable& near,
                        const MovingGuide& surface, Positions& guide, const Context& context) {
  Positions landed(stranded.size());
  for_blocks(context, stranded.size(), 256, [&](std::size_t begin, std::size_t end) {
    MovingGuide::Search search;
    for (std::size_t k = begin; k < end; ++k) {
      const Eigen::Vector3d& p = points[stranded[k]];
      const double bound = surface.to_nearest_staying(p, near[stranded[k]]);
      const Index from = surface.nearest(p, 1, search, bound).front().index;
      const std::vector<Neighbor>& found =
          surface.nearest_of(from, guide, near[from], kNeighbourhood, search);
      const Eigen::Vector3d at = project(guide, found, p);
      double squared = 0;  // to the farthest
      for (const Neighbor& q : found)
        squared = std::max(squared, rfs_mesh::squared_distance(guide[q.index], at));
      landed[k] = project(guide, surface.nearest(at, kNeighbourhood, search, squared), p);
    }
  });
  std::vector<Index> moved;
  for (std::size_t k = 0; k < stranded.size(); ++k) {
    const Index i = stranded[k];
    if (!landed[k].allFinite() || !((landed[k] - points[i]).norm() < most[i])) continue;
    guide[i] = landed[k];
    moved.push_back(i);
  }
  return moved;
}

/// Who is to have a new row: the moved points, and those that had one near.
std::vector<char> beside_moved(const MovingGuide& surface, const NeighborTable& near,
                               const Context& context) {
  std::vector<char> beside(near.size());
  for_each_index(context, near.size(), [&](std::size_t i) {
    const auto row = near[i];
    beside[i] = char(!surface.stays(Index(i)) ||
                     !std::all_of(row.begin(), row.end(), [&](Index j) { return surface.stays(j); }));
  });
  return beside;
}

/// A guide and those of its points that are moved.
struct Landing {
  Landing(const Positions& guide, const Context& context)
      : surface(guide, context), near(surface.before().nearest(HeightField::kNear, context)) {}

  /// Moves the points (stranded.h) and returns which. Once.
  std::vector<Index> move_stranded(const Positions& points, const Adjacency& rings,
                                   const std::vector<double>& most, Positions& guide,
                                   const Context& context) {
    std::vector<Index> moved;
    if (near.k < HeightField::kNear) return moved;
    for (int round = 0; round < kStrandedRounds; ++round) {
      const std::vector<Index> stranded = find_stranded(rings, guide, near, context);
      if (round == 0) found = stranded.size();
      if (stranded.empty() || guide.size() - stranded.size() <= std::size_t(HeightField::kNear)) break;
      // None of them is part of the surface that they are put onto, wherever it was put before.
      std::vector<Index> others;
      std::set_difference(moved.begin(), moved.end(), stranded.begin(), stranded.end(),
                          std::back_inserter(others));
      for (const Index i : stranded) surface.set_gone(i, true);
      surface.set_moved(others, guide, context);
      const std::vector<Index> landed = land(points, stranded, most, near, surface, guide, context);
      for (const Index i : stranded)
        if (!std::binary_search(moved.begin(), moved.end(), i)) surface.set_gone(i, false);
      std::vector<Index> all;
      std::set_union(moved.begin(), moved.end(), landed.begin(), landed.end(), std::back_inserter(all));
      for (const Index i : landed) surface.set_gone(i, true);
      moved = std::move(all);
      if (round + 1 == kStrandedRounds) break;
      surface.renew_rows(moved, guide, near, context);
    }
    return moved;
  }

  MovingGuide surface;
  NeighborTable near;     ///< of where the guide was; rows of moved points are no longer right
  std::size_t found = 0;  ///< stranded points at first
};

}  // namespace

Landed land_stranded(const Positions& points, const Adjacency& rings, const std::vector<double>& most,
                     Positions& guide, const Context& context) {
  Landing landing(guide, context);
  std::vector<char> beside;
  if (!landing.move_stranded(points, rings, most, guide, context).empty())
    beside = beside_moved(landing.surface, landing.near, context);
  rfs_mesh::SpatialIndex index(guide, landing.surface.release_tree(), context);
  if (!beside.empty()) index.renew(landing.near, beside, context);
  return {landing.found, std::move(landing.near), index.release_tree()};
}

void land_stranded_only(const Positions& points, const Adjacency& rings, const std::vector<double>& most,
                        Positions& guide, const Context& context) {
  Landing(guide, context).move_stranded(points, rings, most, guide, context);
}

}  // namespace rfsmooth::smoothing
