/// Surfaces of our own making for the benchmark, as triangle meshes in their own units.
#pragma once

#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::bench {

rfs_mesh::Mesh box(double x, double y, double z);
rfs_mesh::Mesh l_part();                           ///< an L of two unit squares' legs, one deep
rfs_mesh::Mesh sphere();                           ///< radius 1; the facets are within 2e-5 of it
rfs_mesh::Mesh torus(double major, double minor);  ///< the facets are within 1e-4 minor radii
rfs_mesh::Mesh sheet(double width,
                     int cells);  ///< open, wavy: z = 0.1 sin(2 pi x / width) cos(2 pi y / width)

}  // namespace rfsmooth::bench
