/// Poisson-disk sampling of a triangle mesh with an exact number of points.
///
/// C. Yuksel, "Sample Elimination for Generating Poisson Disk Sample Sets", Computer Graphics Forum 34, 2015:
/// five times as many uniform points, then the most crowded one is taken away until n are left; crowding is
/// the sum of (1 - d / 2r)^8 over the points within 2r, r = sqrt(area / (2 sqrt(3) n)), d not below the
/// weight limit of section 4.2 (beta 0.65, gamma 1.5).
#pragma once

#include <cstdint>

#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::bench {

/// n points of the mesh's surface, the same for the same seed. O(n log n), one thread.
Positions poisson_disk(const rfs_mesh::Mesh& mesh, std::size_t n, std::uint64_t seed);

}  // namespace rfsmooth::bench
