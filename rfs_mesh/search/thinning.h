/// Ever sparser, evenly spread subsets of a cloud, each inside the one before.
///
/// A thinning keeps a maximal independent set of the graph of the k nearest neighbours (Luby 1986, with the
/// sum of squared distances to them as the priority, ties by index, and the order mixed where it takes too
/// many rounds): no two kept points are neighbours, and every other one has a kept neighbour. It depends on
/// distances alone, so it turns with the cloud and does not know the order of the points. Thread safe: no
/// state is kept.
#pragma once

#include <functional>
#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// k where nothing else is said.
constexpr std::size_t kThinNear = 3;

/// A subset of `subset` (ascending indices into points) with about 0.4 of its size, ascending; at least one
/// index if `subset` has any. O(n log n) in the size of the subset, deterministic.
std::vector<Index> thin(const Positions& points, const std::vector<Index>& subset, const Context& context);

/// The same of all points (n x 3), whose nearest are known, by the first k of them (all if there are fewer).
/// About 1 / (1.3 + k / 2) of n are kept, of points on a surface and of points that are noisy all the same.
std::vector<Index> thin_all(const Positions& points, const NeighborTable& near, const Context& context,
                            std::size_t k = kThinNear);

/// thin() of a subset that is not much sparser than the points: the nearest of the subset are found among the
/// nearest of all, and searched only where too few of them belong to it. \param near writes the `width`
/// nearest of a point to `row`
std::vector<Index> thin_dense(const SpatialIndex& index, std::size_t width,
                              const std::function<void(Index i, Index* row)>& near,
                              const std::vector<Index>& subset, const Context& context);

}  // namespace rfsmooth::rfs_mesh
