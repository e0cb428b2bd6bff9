#include "pipeline/true_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <Eigen/Geometry>

#include "rfs_mesh/edge_faces.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::pipeline {

using Eigen::Vector3d;

namespace {

Box box_of(const Triangle& triangle) {
  Box box;
  for (const Vector3d& corner : triangle) box.extend(corner);
  return box;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& items) : order_(items.size()) {
  std::iota(order_.begin(), order_.end(), Index{0});
  if (items.empty()) return;
  nodes_.emplace_back();
  split(0, 0, items.size(), items);
}

void BoxTree::split(std::size_t node, std::size_t first, std::size_t last, const std::vector<Box>& items) {
  constexpr std::size_t kLeaf = 6;
  Box box;
  for (std::size_t k = first; k < last; ++k) box.extend(items[order_[k]]);
  nodes_[node].box = box;
  if (last - first <= kLeaf) {
    nodes_[node].first = Index(first);
    nodes_[node].count = Index(last - first);
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto centre = [&](Index i) { return items[i].min()[axis] + items[i].max()[axis]; };
  const auto begin = order_.begin();
  const std::size_t middle = first + (last - first) / 2;
  std::nth_element(begin + std::ptrdiff_t(first), begin + std::ptrdiff_t(middle),
                   begin + std::ptrdiff_t(last), [&](Index a, Index b) {
                     const double ca = centre(a), cb = centre(b);
                     return ca < cb || (ca == cb && a < b);
                   });
  const std::size_t children = nodes_.size();
  nodes_[node].first = Index(children);
  nodes_.resize(children + 2);
  split(children, first, middle, items);
  split(children + 1, middle, last, items);
}

PointTree::PointTree(Positions points) : points_(std::move(points)) {
  std::vector<Box> boxes(points_.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = Box(points_[i]);
  tree_ = BoxTree(boxes);
}

PointTree::Hit PointTree::nearest(const Vector3d& query, Index skip) const {
  Hit hit{kNone, std::numeric_limits<double>::infinity()};
  tree_.search([&](const Box& box) { return box.squaredExteriorDistance(query); },
               [&](Index i) {
                 if (i == skip) return;
                 const double d = (points_[i] - query).squaredNorm();
                 if (d < hit.squared || (d == hit.squared && i < hit.point)) hit = {i, d};
               },
               hit.squared);
  return hit;
}

double PointTree::squared_distance_from(const Triangle& triangle) const {
  const Box extent = box_of(triangle);
  double best = std::numeric_limits<double>::infinity();
  tree_.search([&](const Box& box) { return box.squaredExteriorDistance(extent); },
               [&](Index i) {
                 const Vector3d& p = points_[i];
                 best = std::min(best, (nearest_on_triangle(p, triangle).point - p).squaredNorm());
               },
               best);
  return best;
}

namespace {

/// The nearest point of a segment, and whether it is inside (0), at a (1) or at b (2).
std::pair<Vector3d, int> nearest_on_segment(const Vector3d& q, const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double along = ab.dot(q - a), length = ab.squaredNorm();
  if (along <= 0) return {a, 1};
  if (along >= length) return {b, 2};
  return {a + along / length * ab, 0};
}

/// The nearest point on the boundary of a triangle.
TrianglePoint nearest_on_rim(const Vector3d& q, const Triangle& t) {
  TrianglePoint best;
  double squared = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const auto [point, end] = nearest_on_segment(q, t[std::size_t(a)], t[std::size_t(b)]);
    const double d = (point - q).squaredNorm();
    if (d < squared) {
      squared = d;
      best = {point, end == 0 ? 1 + k : end == 1 ? 4 + a : 4 + b};
    }
  }
  return best;
}

}  // namespace

TrianglePoint nearest_on_triangle(const Vector3d& q, const Triangle& t) {
  const Vector3d ab = t[1] - t[0], ac = t[2] - t[0], aq = q - t[0];
  const Vector3d normal = ab.cross(ac);
  const double area2 = normal.squaredNorm();
  // A needle thinner than rounding has no inside worth asking about.
  if (area2 > 1e-24 * ab.squaredNorm() * ac.squaredNorm()) {
    const double v = aq.cross(ac).dot(normal), w = ab.cross(aq).dot(normal);
    if (v > 0 && w > 0 && v + w < area2) return {q - aq.dot(normal) / area2 * normal, 0};
  }
  return nearest_on_rim(q, t);
}

TrueSurface::TrueSurface(Positions vertices, std::vector<Face> faces)
    : vertices_(std::move(vertices)), faces_(std::move(faces)) {
  if (faces_.empty()) throw std::invalid_argument("a true surface needs at least one face");
  for (const Face& face : faces_)
    for (const Index v : face)
      if (v >= vertices_.size()) throw std::invalid_argument("a face names a vertex that does not exist");
  weld();
  make_pseudo_normals();
  std::vector<Box> boxes(faces_.size());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    boxes[f] = box_of(corners(f));
    area_ += 0.5 * rfs_mesh::face_cross(vertices_, faces_[f]).norm();
  }
  tree_ = BoxTree(boxes);
  if (!closed_) return;
  const Vector3d origin = vertices_[faces_[0][0]];  // any point will do; a near one keeps the sum exact
  double six_volumes = 0;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Triangle t = corners(f);
    six_volumes += (t[0] - origin).dot((t[1] - origin).cross(t[2] - origin));
  }
  side_ = six_volumes < 0 ? -1 : 1;
  volume_ = std::abs(six_volumes) / 6;
}

void TrueSurface::weld() {
  std::vector<Index> order(vertices_.size());
  std::iota(order.begin(), order.end(), Index{0});
  const auto less = [&](Index a, Index b) {
    const Vector3d &p = vertices_[a], &q = vertices_[b];
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != q[axis]) return p[axis] < q[axis];
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<Index> first(vertices_.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] =
        k > 0 && vertices_[order[k]] == vertices_[order[k - 1]] ? first[order[k - 1]] : order[k];
  for (Face& face : faces_)
    for (Index& v : face) v = first[v];
}

void TrueSurface::make_pseudo_normals() {
  vertex_normals_.assign(vertices_.size(), Vector3d::Zero());
  edge_normals_.resize(faces_.size());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Triangle t = corners(f);
    const Vector3d normal = face_normal(f);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d u = (t[(k + 1) % 3] - t[k]).normalized(), v = (t[(k + 2) % 3] - t[k]).normalized();
      const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
      if (std::isfinite(angle)) vertex_normals_[faces_[f][k]] += angle * normal;
    }
  }
  closed_ = true;
  using rfs_mesh::EdgeFace;
  rfs_mesh::for_each_edge(rfs_mesh::edge_faces(faces_), [&](const EdgeFace* first, const EdgeFace* last) {
    if (first->a == first->b) return;
    Vector3d sum = Vector3d::Zero();
    for (const EdgeFace* e = first; e != last; ++e) sum += face_normal(e->face);
    if (last - first != 2 || first[0].forward == first[1].forward) closed_ = false;
    for (const EdgeFace* e = first; e != last; ++e) edge_normals_[e->face][(e->corner + 2) % 3] = sum;
  });
}

Triangle TrueSurface::corners(std::size_t face) const {
  return {vertices_[faces_[face][0]], vertices_[faces_[face][1]], vertices_[faces_[face][2]]};
}

Vector3d TrueSurface::face_normal(std::size_t face) const {
  const Vector3d normal = rfs_mesh::face_cross(vertices_, faces_[face]);
  const double length = normal.norm();
  return length > 0 ? Vector3d(normal / length) : Vector3d(Vector3d::Zero());
}

TrueSurface::Hit TrueSurface::nearest(const Vector3d& query) const {
  Hit hit;
  hit.squared = std::numeric_limits<double>::infinity();
  tree_.search([&](const Box& box) { return box.squaredExteriorDistance(query); },
               [&](Index f) {
                 const TrianglePoint on = nearest_on_triangle(query, corners(f));
                 const double d = (on.point - query).squaredNorm();
                 if (d < hit.squared || (d == hit.squared && f < hit.face))
                   hit = {f, d, on.point, on.feature};
               },
               hit.squared);
  return hit;
}

double TrueSurface::signed_distance(const Vector3d& query, const Hit& hit) const {
  Vector3d normal;
  if (hit.feature == 0)
    normal = face_normal(hit.face);
  else if (hit.feature <= 3)
    normal = edge_normals_[hit.face][std::size_t(hit.feature - 1)];
  else
    normal = vertex_normals_[faces_[hit.face][std::size_t(hit.feature - 4)]];
  return std::copysign(std::sqrt(hit.squared), side_ * normal.dot(query - hit.point));
}

}  // namespace rfsmooth::pipeline
