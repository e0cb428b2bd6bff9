/// `connect` (rfsmooth/connect.h) for a caller who has searched the points already.
#pragma once

#include <rfsmooth/connect.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// Enters what `whole` does not have of the noise, the spacing and the scale. `near`: at least the nearest of
/// each. O(n), parallel, deterministic.
void measure_cloud(const SpatialIndex& index, const NeighborTable& near, Statistics& whole,
                   const Context& context);

/// Connects the points of `index`. `near`: their nearest `options.neighbours`. \throw std::invalid_argument
/// if `near` is of another width or size. \param statistics `scale` and `spacing` are taken if they are
/// there, else entered.
Result<Connection> connect(SpatialIndex index, NeighborTable near, const ConnectOptions& options,
                           const Context& context, Statistics* statistics = nullptr);

}  // namespace rfsmooth::rfs_mesh
