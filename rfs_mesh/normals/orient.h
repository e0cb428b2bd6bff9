/// Orients normals: on the same side along every neighbourhood, outward on closed shapes, towards the scanner
/// where it is known.
///
/// 1. Two normals at the ends of an edge e (a unit vector) agree if, rolled from one end to the other along
///    the circle through both,
///        a = n_i . (n_j - 2 (n_j . e) e)
///    is positive. |a| is how sure that is. It is 1 in a plane, on a sphere, across a sharp edge and from one
///    side of a thin sheet to the other (Konig and Gumhold 2009, "Consistent propagation of normal
///    orientations in point clouds", section 3). Hoppe et al. 1992, 3.3, compare n_i . n_j, which fails in
///    the last two cases.
/// 2. Along the edges of the mesh and of the EMST points grow together into regions, the surest first, by the
///    sum of all edges between two regions (sides.h). Bridges are not used, but a connected part of fewer
///    than 24 points follows the bridge it hangs on. Every other part gets its side as a whole:
/// 3. Without a viewpoint the side is outward, by the sign of the part's volume, sum of a_i (p_i - c) . n_i
///    over its points of area a_i and centroid c. A part that is nearly flat has no outward side and is
///    turned to +z (then +y, +x); an open sheet faces away from its centroid.
/// 4. The winding number checks this: it is 1/2 on a closed surface whose normals are right (winding.h).
///    Where it is not, the Gauss formula gives votes for the sides of up to 50,000 points, the regions are
///    grown again with these votes, and each part takes the result nearer to 1/2. This separates the sheets
///    of thin plates that noise has mixed, and the wall of a cavity faces the cavity.
/// 5. With a viewpoint the points visible from it vote instead, each by the cosine of its normal to the ray
///    (visible.h); points connected to them follow. A part with no visible point goes by 3.
///
/// The result does not depend on the sides of the input normals, nor on the number of threads, nor (except
/// for flat parts) on the frame.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// Turns each of `normals` (n x 3, unit) to its side in place; returns the number of parts that got their
/// side as a whole. `mesh`: positions and one-rings. `tree`: the EMST, or any edges that connect what belongs
/// together; `bridges`: those of them that are no neighbourhood (may be empty). `viewpoint`: in the frame of
/// the positions. `calm`: the same points nearer to the surface (their shadows); rule 1 compares normals
/// there, because with noise of a spacing the edges between the points themselves have arbitrary directions.
/// \param part out, unless null: n, which part each vertex is of, by a vertex of it. O(E log E), mostly
/// parallel. Thread safe.
std::size_t orient(const Mesh& mesh, const std::vector<Edge>& tree, const std::vector<Edge>& bridges,
                   const std::optional<Eigen::Vector3d>& viewpoint, Positions& normals,
                   const Context& context, const Positions* calm = nullptr,
                   std::vector<Index>* part = nullptr);

}  // namespace rfsmooth::rfs_mesh
