#include "pipeline/surface/hole_filling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "pipeline/surface/topology.h"
#include "rfs_mesh/edge_faces.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::pipeline {

namespace {

// Vertices of a rim. A filling takes memory as their square and time as their cube.
constexpr std::size_t kLongestRim = 1000;
constexpr double kNever = std::numeric_limits<double>::infinity();
// Largest area of a filling over that of the piece it belongs to, sqrt(1/2). An outline closed with a second
// sheet has 1, the lid of a half sphere 1/2; this is half-way between them, as a ratio.
constexpr double kMostOfPiece = M_SQRT1_2;

/// The rims, each as its vertices in the order in which a filling face runs along them.
std::vector<std::vector<Index>> rims_of(const Mesh& mesh) {
  std::vector<Index> next(mesh.positions.size(), kNone);
  std::vector<char> branches(next.size(), 0);
  rfs_mesh::for_each_edge(rfs_mesh::edge_faces(mesh.faces), [&](const rfs_mesh::EdgeFace* first,
                                                                const rfs_mesh::EdgeFace* last) {
    if (last - first != 1) return;
    // The face runs from..to, so the face across the rim runs to..from.
    const auto [from, to] = first->forward ? std::pair(first->a, first->b) : std::pair(first->b, first->a);
    branches[to] = branches[to] || next[to] != kNone;
    next[to] = from;
  });
  std::vector<std::vector<Index>> rims;
  std::vector<char> seen(next.size(), 0);
  for (Index start = 0; start < next.size(); ++start) {
    std::vector<Index> rim;
    bool simple = true;
    Index v = start;
    for (; v != kNone && !seen[v]; v = next[v]) {
      seen[v] = 1;
      simple = simple && !branches[v];
      rim.push_back(v);
    }
    if (simple && v == start && rim.size() >= 3) rims.push_back(std::move(rim));
  }
  return rims;
}

/// The area of the piece, connected through vertices, that each vertex belongs to.
std::vector<double> piece_areas(const Mesh& mesh) {
  DisjointSets<Index> pieces = pieces_of(mesh.positions.size(), mesh.faces);
  std::vector<double> areas(mesh.positions.size(), 0);
  for (const Face& face : mesh.faces)
    areas[pieces.of(face[0])] += 0.5 * rfs_mesh::face_cross(mesh.positions, face).norm();
  for (Index v = 0; v < areas.size(); ++v) areas[v] = areas[pieces.of(v)];
  return areas;
}

/// The edges of a mesh, and those added since.
class EdgeSet {
 public:
  explicit EdgeSet(const Mesh& mesh) : ring_(mesh.one_ring) {}
  bool has(Index a, Index b) const {
    const auto row = ring_[a];
    return std::binary_search(row.begin(), row.end(), b) || added_.count(rfs_mesh::edge_between(a, b)) > 0;
  }
  void add(Index a, Index b) { added_.insert(rfs_mesh::edge_between(a, b)); }

 private:
  const Adjacency& ring_;
  std::set<Edge> added_;
};

/// Least-area triangulations of all stretches of a rim, by dynamic programming.
class Filling {
 public:
  Filling(const std::vector<Index>& rim, const Positions& at, const EdgeSet& edges, double longest)
      : rim_(rim), at_(at), n_(rim.size()), area_(n_ * n_, kNever), middle_(n_ * n_, 0) {
    for (std::size_t i = 0; i + 1 < n_; ++i) area_[i * n_ + i + 1] = 0;
    for (std::size_t width = 2; width < n_; ++width)
      for (std::size_t i = 0; i + width < n_; ++i) {
        const std::size_t j = i + width;
        const bool whole = width + 1 == n_;  // its long side is the rim's own last edge
        if (!whole && ((at[rim[i]] - at[rim[j]]).norm() > longest || edges.has(rim[i], rim[j]))) continue;
        choose(i, j);
      }
  }

  bool found() const { return area() < kNever; }
  double area() const { return area_[n_ - 1]; }

  /// The faces of the filling; calls `on_edge(a, b)` for the new edges.
  template <class OnEdge>
  std::vector<Face> faces(OnEdge&& on_edge) const {
    std::vector<Face> out;
    std::vector<std::pair<std::size_t, std::size_t>> open = {{0, n_ - 1}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      if (j == i + 1) continue;
      if (j - i + 1 < n_) on_edge(rim_[i], rim_[j]);
      const std::size_t k = middle_[i * n_ + j];
      out.push_back({rim_[i], rim_[k], rim_[j]});
      open.emplace_back(i, k);
      open.emplace_back(k, j);
    }
    return out;
  }

 private:
  void choose(std::size_t i, std::size_t j) {
    for (std::size_t k = i + 1; k < j; ++k) {
      const double below = area_[i * n_ + k] + area_[k * n_ + j];
      if (!(below < area_[i * n_ + j])) continue;
      const Eigen::Vector3d &a = at_[rim_[i]], &b = at_[rim_[k]], &c = at_[rim_[j]];
      const double area = below + 0.5 * (b - a).cross(c - a).norm();
      if (area < area_[i * n_ + j]) {
        area_[i * n_ + j] = area;
        middle_[i * n_ + j] = Index(k);
      }
    }
  }

  const std::vector<Index>& rim_;
  const Positions& at_;
  std::size_t n_;
  std::vector<double> area_;
  std::vector<Index> middle_;
};

}  // namespace

std::size_t fill_holes(Mesh& mesh, double longest_edge, const Context& context) {
  EdgeSet edges(mesh);
  const std::vector<double> areas = piece_areas(mesh);
  std::vector<Face> added;
  std::size_t filled = 0;
  for (const std::vector<Index>& rim : rims_of(mesh)) {
    context.check_stop();
    if (rim.size() > kLongestRim) continue;
    const Filling filling(rim, mesh.positions, edges, longest_edge);
    if (!filling.found() || filling.area() > kMostOfPiece * areas[rim.front()]) continue;
    const std::vector<Face> faces = filling.faces([&](Index a, Index b) { edges.add(a, b); });
    added.insert(added.end(), faces.begin(), faces.end());
    ++filled;
  }
  mesh.faces.insert(mesh.faces.end(), added.begin(), added.end());
  if (filled > 0) rebuild_adjacency(mesh, context);
  return filled;
}

}  // namespace rfsmooth::pipeline
