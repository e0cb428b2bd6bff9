/// Boruvka's algorithm for the Euclidean minimum spanning tree of a cloud (emst.h).
///
/// In every round each component picks its shortest edge to another component, and the picked edges join the
/// components: at most log2 n rounds, 11 at 1M noisy surface points. The shortest edge is looked for in two
/// places, cheapest first:
///
/// 1. In a point's list of nearest neighbours; those of its own component are skipped.
/// 2. In the kd-tree (foreign_search.h), if the list is used up and its last neighbour is nearer than the
///    component's best edge so far. That edge bounds the search, and subtrees of the own component are
///    skipped. The points of a leaf share one walk. A node whose points are all of one component is skipped
///    once nothing foreign was found near its box.
///
/// Bounds only save work: the edge picked is the least by (length^2, min id, max id), whichever thread looked
/// first. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// n - 1 edges {a < b}, in no order. \throw std::invalid_argument if `lists` is not of the index's points.
std::vector<Edge> boruvka(const SpatialIndex& index, const NeighborTable& lists, const Context& context);

}  // namespace rfsmooth::rfs_mesh
