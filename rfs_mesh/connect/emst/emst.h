/// The Euclidean minimum spanning tree (EMST) of a cloud: exact, parallel, deterministic.
///
/// The first stage of Vollmer et al. section 7 (after Mencl): the tree of n - 1 edges of least total length
/// that connects all points. Kruskal over a Delaunay triangulation gives the same tree; here Boruvka's
/// algorithm finds it from lists of nearest neighbours and the kd-tree (boruvka.h).
///
/// Ties are broken by (length^2, min id, max id). This is a total order, so the tree is unique: the same
/// edges for any number of threads. Coincident points are joined by edges of length zero.
///
/// About O(n log n). At 1M noisy surface points on one thread it takes a fifth to a quarter of the time of
/// CGAL's sequential Delaunay + Kruskal, and 141 bytes a point at the peak beside the caller's array, working
/// cloud and index included (tests/bench/rfs_mesh/emst_bench.cpp). Thread safe; a cancel is noticed within a
/// block of a round.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The n - 1 edges {a < b} of the EMST of the index's points, ascending by (length^2, a, b); none for n < 2.
std::vector<Edge> emst(const SpatialIndex& index, const Context& context);

/// The same tree from a table of the index's nearest neighbours (any k >= 1). The search for these takes most
/// of the other function's time.
std::vector<Edge> emst(const SpatialIndex& index, const NeighborTable& nearest, const Context& context);

}  // namespace rfsmooth::rfs_mesh
