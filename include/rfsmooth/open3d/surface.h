/// Surface reconstruction by Open3D: screened Poisson (Kazhdan and Hoppe 2013) and ball pivoting (Bernardini
/// et al. 1999), with their scale parameters taken from the measured spacing. No header of Open3D is needed
/// for this one.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/reconstruct.h>
#include <rfsmooth/result.h>

namespace rfsmooth::open3d {

/// Closes the surface over every gap: `points` and `normals` are n x 3 in the same frame, normals unit length
/// and consistently oriented (outward gives outward faces); `spacing` > 0 in world units sets the finest
/// octree cell, so the depth is about log2(extent / spacing), between 4 and 12. Faces far from the points are
/// invented; `reconstruct` trims them. Errors: no_usable_points if Poisson makes no surface, out_of_memory;
/// cancelled only before Open3D begins. \throw std::invalid_argument if the sizes differ or spacing <= 0. One
/// thread, the same bytes every time. Thread safe: no state is kept, here as below.
Result<Mesh> poisson(const Positions& points, const Positions& normals, double spacing,
                     const Context& context);

/// Rolls balls of 1, 2 and 4 times `spacing` over the points; the vertices are the points, in order. Leaves
/// holes where no ball rests on three points. Arguments, errors and cancelling as for `poisson`.
Result<Mesh> ball_pivoting(const Positions& points, const Positions& normals, double spacing,
                           const Context& context);

/// Both as methods of rfsmooth/reconstruct.h: "poisson" and "ball-pivoting".
std::vector<SurfaceMethod> surface_methods();

}  // namespace rfsmooth::open3d
