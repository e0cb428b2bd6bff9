/// Ridges and ravines of a (smoothed) mesh.
///
///     ridge:   the maximal principal curvature has a positive maximum along its curvature line
///     ravine:  the minimal principal curvature has a negative minimum along its curvature line
///
/// Ohtake, Belyaev, Bogaevski 2000, section 5. The curvature tensor of each vertex is fitted to the normal
/// curvatures towards the neighbours with Taubin's (1995) weights. Differs from Taubin: he averages, which
/// assumes that the neighbours' directions are evenly spread, and splits a sphere's k1 and k2 by up to 20 %.
/// The plane of normal and principal direction cuts the one-ring polygon; the curvatures at the two crossings
/// are interpolated linearly and compared.
///
/// Positive curvature bends away from the normal's side, as on a sphere with outward normals. Faces should be
/// oriented alike, else ridges and ravines trade places. Smooth first: ridges depend on third derivatives.
/// Thread safe: no state is kept.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::smoothing {

/// Principal curvatures of every vertex, k1 >= k2, in 1 / world units; zero where the vertex has no faces.
struct PrincipalCurvatures {
  std::vector<double> k1, k2;
  Positions direction1, direction2;  ///< unit tangents; zero where unknown
  Positions normal;                  ///< unit
};

/// The principal curvatures at every vertex.
PrincipalCurvatures principal_curvatures(const Mesh& mesh, const Context& context);

/// n: 1 = ridge, -1 = ravine, 0 = neither. Vertices whose one-ring polygon the plane does not cross twice (at
/// the boundary) are 0. \param least lowest curvature that counts, x 1 / mean edge length.
std::vector<int> ridges_and_ravines(const Mesh& mesh, double least, const Context& context);

}  // namespace rfsmooth::smoothing
