#include <algorithm>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "rfs_mesh/corners.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

namespace {

using Eigen::Vector3d;

/// Cotangents of a face's three angles and what it adds to the area of each corner; all zero if it is
/// skipped.
struct FaceShape {
  std::array<double, 3> cot = {0, 0, 0};
  std::array<double, 3> area = {0, 0, 0};
};

FaceShape shape_of(const Mesh& mesh, const Face& face, Scheme scheme) {
  constexpr double kSliver = 1e-8;  // twice the area over the longest edge squared
  FaceShape shape;
  std::array<double, 3> squared;  // of the edge opposite each corner
  std::array<double, 3> dot;      // of the two edges at each corner
  for (int k = 0; k < 3; ++k) {
    const Vector3d &p = mesh.positions[face[k]], &q = mesh.positions[face[(k + 1) % 3]],
                   &r = mesh.positions[face[(k + 2) % 3]];
    squared[k] = (q - r).squaredNorm();
    dot[k] = (q - p).dot(r - p);
  }
  const Vector3d &a = mesh.positions[face[0]], &b = mesh.positions[face[1]], &c = mesh.positions[face[2]];
  const double doubled = (b - a).cross(c - a).norm();
  if (!(doubled > kSliver * std::max({squared[0], squared[1], squared[2]}))) return shape;
  int obtuse = -1;
  for (int k = 0; k < 3; ++k) {
    shape.cot[k] = dot[k] / doubled;
    if (dot[k] < 0) obtuse = k;
  }
  for (int k = 0; k < 3; ++k) {
    const int m = (k + 1) % 3, n = (k + 2) % 3;
    shape.area[k] = scheme == Scheme::printed ? doubled / 2
                    : obtuse < 0              ? (squared[m] * shape.cot[m] + squared[n] * shape.cot[n]) / 8
                    : obtuse == k             ? doubled / 4
                                              : doubled / 8;
  }
  return shape;
}

}  // namespace

Operator curvature(const Mesh& mesh, const Adjacency& vertex_faces, const Context& context, Scheme scheme) {
  Operator op;
  const Adjacency& rows = mesh.one_ring;
  const double h = length_unit(mesh, context);
  op.unit = h * h;
  op.mass.resize(mesh.positions.size());
  op.weight.assign(rows.items.size(), 0);
  std::vector<FaceShape> shape(mesh.faces.size());
  for_each_index(context, shape.size(),
                 [&](std::size_t f) { shape[f] = shape_of(mesh, mesh.faces[f], scheme); });
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    const auto add = [&](Index j, double cot) { op.weight[item_of(rows, i, j)] += 0.5 * cot; };
    double area = 0;
    for (const Index f : vertex_faces[i]) {
      const Face& face = mesh.faces[f];
      const Index k = rfs_mesh::corner_of(face, Index(i)), m = (k + 1) % 3, n = (k + 2) % 3;
      add(face[m], shape[f].cot[n]);
      add(face[n], shape[f].cot[m]);
      area += shape[f].area[k];
    }
    op.mass[i] = area > 0 ? 2 * area : op.unit;
  });
  return op;
}

Operator normalised(const Adjacency& rows, Operator op, const Context& context) {
  constexpr double kLeast = 1e-9;  // of the sum of |w|: keeps 1 / m finite
  op.mass = weight_sums(rows, op, context);
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    double sum = 0;
    for (Index k = rows.start[i]; k < rows.start[i + 1]; ++k) sum += op.weight[k];
    op.mass[i] = op.mass[i] > 0 ? std::max(sum, kLeast * op.mass[i]) : 1;
  });
  op.unit = 1;
  return op;
}

}  // namespace rfsmooth::smoothing
