/// The stages of `connect` for a caller who has searched the points already.
#pragma once

#include <rfsmooth/connect.h>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// `connect` (rfsmooth/connect.h) for a caller who has an index over the points already and the rows of their
/// nearest `options.neighbours`. \throw std::invalid_argument if `near` is of another width or size.
Result<Connection> connect(SpatialIndex index, NeighborTable near, const ConnectOptions& options,
                           const Context& context);

}  // namespace rfsmooth::rfs_mesh
