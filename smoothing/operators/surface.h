/// What the curvature-driven flows read off a mesh: normals that need no orientation, angle deficits, and the
/// gradients of area and volume.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::smoothing {

/// The unit normal of vertex i up to its sign: the sum of its faces' area vectors, each turned to the side of
/// the largest. Zero without a face that has area. Works on meshes whose faces do not agree in orientation.
Eigen::Vector3d unsigned_normal(const Mesh& mesh, const Adjacency& vertex_faces, Index i);

/// n: 1 where every edge at the vertex has exactly two faces, so that the angle deficit means something.
std::vector<char> interior_vertices(const Mesh& mesh, const Adjacency& vertex_faces, const Context& context);

/// Gauss curvature times mixed area: 2 pi - sum of the angles at vertex i. Meaningful at interior vertices.
double angle_deficit(const Mesh& mesh, const Adjacency& vertex_faces, Index i);

/// The faces turned so that neighbours agree and closed parts face outward. Failure (usage), naming the first
/// offending edge, if the mesh has no face, is open, non-manifold at an edge, or not orientable: `what` says
/// what needs it.
std::vector<Face> closed_and_oriented(const Mesh& mesh, const char* what);

/// The same for any mesh, as far as it goes: neighbours agree across edges of two faces, except where the
/// mesh has only one side; parts face away from their centre.
std::vector<Face> oriented_as_far_as_possible(const Mesh& mesh);

}  // namespace rfsmooth::smoothing
