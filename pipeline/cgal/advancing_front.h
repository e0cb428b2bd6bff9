/// Surface reconstruction by CGAL's advancing front (Cohen-Steiner and Da 2004): a Delaunay-based surface
/// through the points themselves, without normals. The package is GPL-3.0-or-later: linking rfsmooth::cgal
/// makes the binary so.
#pragma once

#include "rfsmooth/pipeline/reconstruct.h"
#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/mesh.h"
#include "rfsmooth/rfs_mesh/result.h"

namespace rfsmooth::cgal {

/// The vertices are the points, in order (those the front does not reach have no face); faces are oriented
/// consistently within each component. `longest_edge` in world units (0 = no limit) keeps the front from
/// crossing gaps. Errors: no_usable_points if there is no surface. O(n log n), one thread, deterministic; not
/// interruptible.
Result<rfs_mesh::Mesh> advancing_front(const Positions& points, double longest_edge, const Context& context);

/// The same as a method of pipeline/reconstruct.h.
pipeline::SurfaceMethod advancing_front_method();

}  // namespace rfsmooth::cgal
