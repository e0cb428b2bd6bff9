/// Boruvka's rounds over a cloud: the edges of its Euclidean minimum spanning tree (emst.h), in no order.
///
/// In every round each component picks its shortest edge to another one, and the picked edges join the
/// components: at most log2 n rounds, 11 at 1M noisy surface points. Where the shortest edge comes from,
/// cheapest first:
///
/// 1. A point's list of nearest neighbours, from which its own component's are skipped.
/// 2. Where the list is used up and its last is nearer than the component's best edge so far, the kd-tree,
///    with that edge as the bound and passing over subtrees of the own component (foreign_search.h). The
///    points of a leaf share one walk, and nodes inside a component are passed over as a whole once nothing
///    foreign was found near their box.
///
/// Bounds only ever save work: what is picked is the least by (length^2, min id, max id), whichever thread
/// looked first. Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// n - 1 edges {a < b}. \throw std::invalid_argument if `lists` is not of the index's points.
std::vector<Edge> boruvka(const SpatialIndex& index, const NeighborTable& lists, const Context& context);

}  // namespace rfsmooth::rfs_mesh
