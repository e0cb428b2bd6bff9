/// Normals on one side: the same side along every neighbourhood, outward on closed shapes, towards the
/// scanner where it is known.
///
/// 1. Two normals at the ends of an edge e (a unit vector) agree if, rolled from one end to the other along
///    the circle through both,
///        a = n_i . (n_j - 2 (n_j . e) e)
///    is positive; |a| says how sure that is: 1 in a plane, on a sphere, across a sharp edge and from one
///    side of a thin sheet to the other (Konig and Gumhold 2009, "Consistent propagation of normal
///    orientations in point clouds", section 3; Hoppe et al. 1992, 3.3, compares n_i . n_j, which fails at
///    the last two).
/// 2. The edges of the mesh and of the EMST are taken surest first, as in Kruskal's tree, and each that joins
///    two parts turns one of them. Bridges come last: they are not neighbourhood.
/// 3. Every part between bridges is given its side as a whole: towards the viewpoint where its points can see
///    it; else outward, by the sign of its volume, sum of a_i (p_i - c) . n_i over its points of area a_i and
///    centroid c; a part that is as good as flat has no outward and is turned to +z (then +y, +x).
///
/// The result does not depend on the side the normals came with, on the number of threads, or (up to that
/// last rule) on the frame.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::rfs_mesh {

/// Turns each of `normals` (n x 3, unit) to its side in place; returns the number of parts that were given
/// their side as a whole. `mesh`: positions and one-rings. `tree`: the EMST, or any edges that connect what
/// belongs together; `bridges`: those among them that are not neighbourhood (may be empty). `viewpoint`: in
/// the frame of the positions. O(E log E); parallel but for the Kruskal. Thread safe.
std::size_t orient(const Mesh& mesh, const std::vector<Edge>& tree, const std::vector<Edge>& bridges,
                   const std::optional<Eigen::Vector3d>& viewpoint, Positions& normals,
                   const Context& context);

}  // namespace rfsmooth::rfs_mesh
