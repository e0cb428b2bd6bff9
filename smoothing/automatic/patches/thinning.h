/// Ever sparser, evenly spread subsets of a cloud, each inside the one before.
///
/// A thinning keeps a maximal independent set of the graph of the three nearest neighbours (Luby 1986, with
/// the sum of squared distances to them as the priority, ties by index): no two kept points are neighbours,
/// and every other one has a kept neighbour. It depends on distances alone, so it turns with the cloud and
/// does not know the order of the points. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::smoothing {

/// A subset of `subset` (ascending indices into points) with about 0.4 of its size, ascending; at least one
/// index if `subset` has any. O(n log n) in the size of the subset, deterministic.
std::vector<Index> thin(const Positions& points, const std::vector<Index>& subset, const Context& context);

/// The same of all points of `index` (four or more), whose nearest (three or more) are known.
std::vector<Index> thin_all(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near,
                            const Context& context);

/// thin() of a subset that is not much sparser than the points: the nearest of the subset are found among the
/// nearest of all, and searched only where too few of them belong to it.
std::vector<Index> thin_dense(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near,
                              const std::vector<Index>& subset, const Context& context);

}  // namespace rfsmooth::smoothing
