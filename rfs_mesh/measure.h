/// Measures of a mesh: areas, volume, edge lengths, angles. World units (squared, cubed) and radians.
///
/// Degenerate faces have zero area and a zero normal. Parallel, the same bits for any number of threads; O(n
/// + m). Thread safe: no state is kept. Precondition of all functions: `check(mesh)` is empty.
#pragma once

#include <Eigen/Core>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

namespace rfsmooth::rfs_mesh {

/// (b - a) x (c - a) of one face: twice its area, along its normal by the right-hand rule.
Eigen::Vector3d face_cross(const Positions& at, const Face& face);

/// Bank & Smith's face quality 4 sqrt(3) A / (l1^2 + l2^2 + l3^2): 1 for the equilateral triangle, 0 for a
/// degenerate one; the same at every scale.
double face_quality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// The angle in [0, pi] at edge pq between the half planes through r and s: pi where the two faces are flat,
/// small where they fold onto each other. Independent of the orientation of the faces. 0 if a face is
/// degenerate.
double dihedral_angle(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r,
                      const Eigen::Vector3d& s);

/// n unit normals: the mean of the incident faces' normals, weighted by area; zero if there are none or they
/// cancel. Neighbours' normals agree only if the faces are oriented alike.
Positions vertex_normals(const Mesh& mesh, const Context& context);

/// The mean of the positions; zero if there are none.
Eigen::Vector3d centroid(const Positions& at, const Context& context);

/// The total area of the faces.
double surface_area(const Mesh& mesh, const Context& context);

/// sum over faces of a . (b x c) / 6, about the centroid of the positions: the volume enclosed by a closed
/// mesh with faces oriented outward (negative if inward). Meaningless on an open or unoriented mesh.
double signed_volume(const Mesh& mesh, const Context& context);

/// Mean length of the edges of the one-ring (faces' and loose edges); 0 without edges.
double mean_edge_length(const Mesh& mesh, const Context& context);

}  // namespace rfsmooth::rfs_mesh
