#include "tests/bench/quality/data/closest.h"

#include <algorithm>
#include <array>

namespace rfsmooth::bench {
namespace {

double squared_to_box(const Eigen::Vector3d& p, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

ClosestTree::ClosestTree(const Positions& points) {
  triangles_.reserve(points.size());
  for (const auto& p : points) triangles_.push_back({p, p, p, Index(triangles_.size())});
  if (!triangles_.empty()) build(0, Index(triangles_.size()));
}

ClosestTree::ClosestTree(const Mesh& mesh) {
  triangles_.reserve(mesh.faces.size());
  for (const auto& f : mesh.faces)
    triangles_.push_back(
        {mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]], Index(triangles_.size())});
  if (!triangles_.empty()) build(0, Index(triangles_.size()));
}

void ClosestTree::build(Index first, Index last) {
  constexpr Index kLeaf = 4;
  const std::size_t at = nodes_.size();
  nodes_.emplace_back();
  Eigen::Vector3d low = triangles_[first].a, high = low, center_low = low, center_high = low;
  center_low = center_high = triangles_[first].a + triangles_[first].b + triangles_[first].c;
  for (Index i = first; i < last; ++i) {
    const Triangle& t = triangles_[i];
    low = low.cwiseMin(t.a).cwiseMin(t.b).cwiseMin(t.c);
    high = high.cwiseMax(t.a).cwiseMax(t.b).cwiseMax(t.c);
    center_low = center_low.cwiseMin(t.a + t.b + t.c);
    center_high = center_high.cwiseMax(t.a + t.b + t.c);
  }
  nodes_[at].low = low;
  nodes_[at].high = high;
  if (last - first <= kLeaf) {
    nodes_[at].first = first;
    nodes_[at].count = last - first;
    return;
  }
  Eigen::Index axis = 0;
  (center_high - center_low).maxCoeff(&axis);
  const Index middle = first + (last - first) / 2;
  std::nth_element(triangles_.begin() + first, triangles_.begin() + middle, triangles_.begin() + last,
                   [axis](const Triangle& s, const Triangle& t) {
                     const double x = s.a[axis] + s.b[axis] + s.c[axis],
                                  y = t.a[axis] + t.b[axis] + t.c[axis];
                     return x != y ? x < y : s.id < t.id;
                   });
  build(first, middle);
  nodes_[at].right = Index(nodes_.size());
  build(middle, last);
}

template <class Visit, class Bound>
void ClosestTree::search(const Eigen::Vector3d& query, Visit&& visit, Bound&& bound) const {
  if (nodes_.empty()) return;
  std::array<std::pair<double, Index>, 64> stack;
  std::size_t top = 0;
  stack[top++] = {0.0, 0};
  while (top > 0) {
    const auto [distance, at] = stack[--top];
    if (distance >= bound()) continue;
    const Node& node = nodes_[at];
    if (node.count > 0) {
      for (Index i = node.first; i < node.first + node.count; ++i) visit(triangles_[i]);
      continue;
    }
    std::pair<double, Index> near{squared_to_box(query, nodes_[at + 1].low, nodes_[at + 1].high), at + 1};
    std::pair<double, Index> far{squared_to_box(query, nodes_[node.right].low, nodes_[node.right].high),
                                 node.right};
    if (far.first < near.first) std::swap(near, far);
    stack[top++] = far;
    stack[top++] = near;
  }
}

ClosestTree::Hit ClosestTree::nearest(const Eigen::Vector3d& query, Index except) const {
  Hit best;
  search(
      query,
      [&](const Triangle& t) {
        if (t.id == except) return;
        const Eigen::Vector3d q = closest_on_triangle(query, t.a, t.b, t.c);
        const double d = (q - query).squaredNorm();
        if (d < best.squared) best = {d, t.id, q};
      },
      [&] { return best.squared; });
  return best;
}

std::vector<std::pair<double, Index>> ClosestTree::k_nearest(const Eigen::Vector3d& query,
                                                             std::size_t k) const {
  std::vector<std::pair<double, Index>> heap;  // the worst of the best k on top
  if (k == 0) return heap;
  heap.reserve(k + 1);
  search(
      query,
      [&](const Triangle& t) {
        const double d = (closest_on_triangle(query, t.a, t.b, t.c) - query).squaredNorm();
        if (heap.size() == k && d >= heap.front().first) return;
        heap.emplace_back(d, t.id);
        std::push_heap(heap.begin(), heap.end());
        if (heap.size() <= k) return;
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
      },
      [&] { return heap.size() < k ? std::numeric_limits<double>::infinity() : heap.front().first; });
  std::sort_heap(heap.begin(), heap.end());
  return heap;
}

}  // namespace rfsmooth::bench
