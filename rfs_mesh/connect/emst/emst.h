/// The Euclidean minimum spanning tree (EMST) of a cloud: exact, parallel, deterministic.
///
/// The first stage of Vollmer et al. section 7 (after Mencl): the tree of n - 1 edges of least total length
/// that connects all points. Kruskal over a Delaunay triangulation gives the same tree; here Boruvka's
/// algorithm finds it. In every round each component picks its shortest edge to another component, and the
/// picked edges join the components: at most log2 n rounds, 11 at 1M noisy surface points. The shortest edge
/// is looked for in two places, cheapest first:
///
/// 1. In a point's list of nearest neighbours; those of its own component are skipped.
/// 2. In the kd-tree (foreign_search.h), if the list is used up and its last neighbour is nearer than the
///    component's best edge so far. That edge bounds the search, and subtrees of the own component are
///    skipped. The points of a leaf share one walk. A node whose points are all of one component is skipped
///    once nothing foreign was found near its box.
///
/// Bounds only save work: the edge picked is the least by (length^2, min id, max id), whichever thread looked
/// first. This is a total order, so the tree is unique: the same edges for any number of threads. Coincident
/// points are joined by edges of length zero.
///
/// About O(n log n). At 1M noisy surface points on one thread it takes a fifth to a quarter of the time of
/// CGAL's sequential Delaunay + Kruskal, and 141 bytes a point at the peak beside the caller's array, working
/// cloud and index included (tests/bench/rfs_mesh/emst_bench.cpp). Thread safe: no state is kept; a cancel is
/// noticed within a block of a round.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The n - 1 edges {a < b} of the EMST of the index's points, ascending by (length^2, a, b); none for n < 2.
/// \param near nearest neighbours of the index's points, any k >= 1: what is not among them is searched in
/// the index. \throw std::invalid_argument if it is not of the index's points.
std::vector<Edge> emst(const SpatialIndex& index, const NeighborTable& near, const Context& context);

/// The same edges in no order, for who sorts them otherwise.
std::vector<Edge> emst_unsorted(const SpatialIndex& index, const NeighborTable& near, const Context& context);

}  // namespace rfsmooth::rfs_mesh
