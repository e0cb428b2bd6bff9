#include "rfs_mesh/search/groups.h"

#include <algorithm>
#include <cmath>

#include "base/collect.h"
#include "base/parallel.h"
#include "rfs_mesh/sample.h"
#include "rfs_mesh/search/thinning.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// So many neighbours leave one point of `members` in a thinning (thin_all).
double neighbours_for(double members) {
  return 2 * (members - 1.3);
}

/// For every point the place in `kept` of the kept point nearest to it. \param at where the kept ones are
std::vector<Index> nearest_kept(const Positions& points, const NeighborTable& near,
                                const std::vector<Index>& kept, const Positions& at, const Context& context) {
  std::vector<Index> number(points.size(), kNone), nearest(points.size());
  for_each_index(context, kept.size(), [&](std::size_t s) { number[kept[s]] = Index(s); });
  for_each_index(context, points.size(), [&](std::size_t i) {
    nearest[i] = number[i];
    for (const Index* j = near[i].begin(); nearest[i] == kNone && j < near[i].end(); ++j)
      nearest[i] = number[*j];
  });
  // A kept point may have this one among its nearest and not the other way round.
  const auto left = rfsmooth::collect<Index>(context, points.size(), [&](std::size_t i, auto&& emit) {
    if (nearest[i] == kNone) emit(Index(i));
  });
  if (left.empty()) return nearest;
  const std::vector<Index> found =
      nearest_points(SpatialIndex(at, context), at_rows(points, left, context), context);
  for (std::size_t l = 0; l < left.size(); ++l) nearest[left[l]] = found[l];
  return nearest;
}

/// The members by the groups that they are in. O(n), one thread.
Adjacency members_of(const std::vector<Index>& group, std::size_t count) {
  Adjacency groups;
  groups.start.resize(count + 1);
  for (const Index g : group) ++groups.start[g + 1];
  for (std::size_t g = 0; g < count; ++g) groups.start[g + 1] += groups.start[g];
  groups.items.resize(group.size());
  std::vector<Index> to(groups.start.begin(), groups.start.end() - 1);
  for (std::size_t i = 0; i < group.size(); ++i) groups.items[to[group[i]]++] = Index(i);
  return groups;
}

}  // namespace

Adjacency group_around_kept(const Positions& points, const NeighborTable& near, std::size_t members,
                            const Context& context) {
  // Steps of the same size, as few as the table allows; the smallest thinning is by kThinNear.
  const double most = std::max(double(near.k), double(kThinNear));
  double steps = 1;
  while (neighbours_for(std::pow(double(members), 1 / steps)) > most) ++steps;
  const auto k = std::size_t(std::lround(neighbours_for(std::pow(double(members), 1 / steps))));

  const auto step = [&](const Positions& from, const NeighborTable& table, Positions& at) {
    const std::vector<Index> kept = thin_all(from, table, context, k);
    at = at_rows(from, kept, context);
    return nearest_kept(from, table, kept, at, context);
  };
  Positions at;
  std::vector<Index> group = step(points, near, at);
  for (; steps > 1; --steps) {
    const Positions from = std::move(at);
    const std::vector<Index> joined = step(from, SpatialIndex(from, context).nearest(int(k), context), at);
    for_each_index(context, group.size(), [&](std::size_t i) { group[i] = joined[group[i]]; });
  }
  return members_of(group, at.size());
}

}  // namespace rfsmooth::rfs_mesh
