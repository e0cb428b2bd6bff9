/// `connect` (rfsmooth/connect.h) for callers inside, who need less of it or have searched the points
/// already.
#pragma once

#include <rfsmooth/connect.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Enters what `whole` does not have of the noise, the spacing and the scale. `near`: at least the nearest of
/// each. O(n), parallel, deterministic.
void measure_cloud(const SpatialIndex& index, const NeighborTable& near, Statistics& whole,
                   const Context& context);

/// What is wanted of a connection; what is not may stay empty.
struct Wanted {
  /// The last stage. Its tree is made and kept even where `emst` and `tree` are false.
  ConnectUpTo up_to = ConnectUpTo::mesh;
  bool emst = true;  ///< whether Connection::emst is wanted; on the shadow it is a tree of its own
  bool tree = true;  ///< whether Connection::tree is wanted
  /// Whether vertices that no face reaches keep their SDG edges (Mesh::loose_edges) and are neighbours by
  /// them.
  bool loose_edges = true;
  /// Whether Connection::surfaces are wanted.
  bool surfaces = true;
  /// Whether small holes are filled: it adds faces, and no edge or neighbour.
  bool fill_holes = true;
};

/// Connects the points as the public `connect` does, and makes no more than what is wanted.
Result<Connection> connect(const Positions& points, const ConnectOptions& options, const Wanted& wanted,
                           const Context& context);

/// The same for the points of `index`. `near`: their nearest `options.neighbours`. \throw
/// std::invalid_argument if `near` is of another width or size. \param statistics `noise`, `scale` and
/// `spacing` are taken if they are there, else entered.
Result<Connection> connect(SpatialIndex index, NeighborTable near, const ConnectOptions& options,
                           const Wanted& wanted, const Context& context, Statistics* statistics = nullptr);

}  // namespace rfsmooth::rfs_mesh
