/// Points of the tails (tails.h), drawn towards the surface that a first smoothing shows. Thread safe: no
/// state is kept.
#pragma once

#include <optional>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/noise/noise.h"
#include "smoothing/automatic/guide/height_field.h"
#include "smoothing/automatic/patches/scales.h"
#include "smoothing/automatic/tails/tails.h"

namespace rfsmooth::smoothing {

/// Makes pseudo-observations `data` (n x 3) of the points. Returns the tails; where there are none, nothing
/// is changed. \param pass of the first smoothing. \param mesh as connected, with the positions as they came.
/// \param whole taken if it is there, else entered. O(n), parallel, the same bits for any number of threads.
Tails tame(const HeightField& field, const MixedScales& pass, const Mesh& mesh,
           const rfs_mesh::NoiseField& noise, std::optional<Statistics::Tails>& whole, Positions& data,
           const Context& context);

/// The noise of these pseudo-observations, from that of the points.
rfs_mesh::NoiseField tamed(rfs_mesh::NoiseField noise, const Tails& tails);

}  // namespace rfsmooth::smoothing
