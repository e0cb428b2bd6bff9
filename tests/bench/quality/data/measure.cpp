#include "tests/bench/quality/data/measure.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/parallel.h"

namespace rfsmooth::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::vector<Eigen::Vector3d> normals_of_faces(const Mesh& mesh) {
  std::vector<Eigen::Vector3d> normals;
  normals.reserve(mesh.faces.size());
  for (const auto& f : mesh.faces) {
    const auto &a = mesh.positions[f[0]], &b = mesh.positions[f[1]], &c = mesh.positions[f[2]];
    normals.push_back((b - a).cross(c - a).normalized());
  }
  return normals;
}

/// The edges whose faces meet at 40 degrees or more, as triangles without area.
Mesh sharp_edges(const Mesh& mesh, const std::vector<Eigen::Vector3d>& normals) {
  const double least = std::cos(40 * kPi / 180);
  std::map<std::pair<Index, Index>, Index> first_face;
  Mesh edges;
  edges.positions = mesh.positions;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      const auto [at, fresh] = first_face.try_emplace(std::minmax(a, b), Index(f));
      if (fresh) continue;
      const Face& other = mesh.faces[at->second];
      const bool same_way = [&] {  // both faces run along the edge the same way: one of them is flipped
        for (std::size_t j = 0; j < 3; ++j)
          if (other[j] == a && other[(j + 1) % 3] == b) return true;
        return false;
      }();
      const double cosine = normals[f].dot(normals[at->second]) * (same_way ? -1 : 1);
      if (cosine <= least) edges.faces.push_back({a, b, b});
    }
  return edges;
}

struct Sums {
  double to_clean = 0, to_surface = 0, angle = 0, gap = 0, gap_squared = 0, at_edges = 0, largest = 0;
  std::size_t count = 0, edge_count = 0;
};

Sums operator+(Sums a, const Sums& b) {
  a.to_clean += b.to_clean;
  a.to_surface += b.to_surface;
  a.angle += b.angle;
  a.gap += b.gap;
  a.gap_squared += b.gap_squared;
  a.at_edges += b.at_edges;
  a.largest = std::max(a.largest, b.largest);
  a.count += b.count;
  a.edge_count += b.edge_count;
  return a;
}

Eigen::Vector3d plane_normal(const Positions& points, const std::vector<std::pair<double, Index>>& near) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& [d, i] : near) mean += points[i];
  mean /= double(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& [d, i] : near) covariance += (points[i] - mean) * (points[i] - mean).transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.compute(covariance);
  return solver.eigenvectors().col(0);
}

}  // namespace

Truth::Truth(std::shared_ptr<const Sample> sample)
    : sample_(std::move(sample)),
      surface_(sample_->mesh),
      clean_(sample_->clean),
      edges_(sharp_edges(sample_->mesh, normals_of_faces(sample_->mesh))),
      face_normals_(normals_of_faces(sample_->mesh)) {
  const double reach = 2 * sample_->spacing;
  near_edge_.reserve(sample_->clean.size());
  for (const auto& p : sample_->clean) near_edge_.push_back(edges_.nearest(p).squared <= reach * reach);
}

Measures Truth::measure(const Positions& points, const std::vector<Index>& source,
                        const Context& context) const {
  constexpr std::size_t kNormalNeighbours = 12;
  Positions kept;
  std::vector<char> edge;
  const double reach = 2 * sample_->spacing;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Index row = source.empty() ? Index(i) : source[i];
    if (!points[i].allFinite() || (row != kNone && row >= sample_->clean.size())) continue;
    kept.push_back(points[i]);
    edge.push_back(row != kNone ? near_edge_[row] : edges_.nearest(points[i]).squared <= reach * reach);
  }
  Measures result;
  result.points = kept.size();
  if (kept.size() < 2) return result;

  in_arena(context, [&] {
    const ClosestTree tree(kept);
    const auto forward = [&](std::size_t begin, std::size_t end) {
      Sums s;
      for (std::size_t i = begin; i < end; ++i) {
        const auto hit = surface_.nearest(kept[i]);
        s.to_clean += clean_.nearest(kept[i]).squared;
        s.to_surface += hit.squared;
        s.largest = std::max(s.largest, hit.squared);
        if (edge[i]) {
          s.at_edges += hit.squared;
          ++s.edge_count;
        }
        const auto near = tree.k_nearest(kept[i], kNormalNeighbours + 1);
        const double gap = std::sqrt(near.at(1).first);
        s.gap += gap;
        s.gap_squared += gap * gap;
        const double cosine = std::abs(plane_normal(kept, near).dot(face_normals_[hit.primitive]));
        s.angle += std::acos(std::min(1.0, cosine)) * 180 / kPi;
        ++s.count;
      }
      return s;
    };
    const Sums s = reduce_blocks(
        context, kept.size(), Sums{}, forward, [](const Sums& a, const Sums& b) { return a + b; }, 512);
    const double back = sum_over(context, sample_->clean.size(), 0.0,
                                 [&](std::size_t i) { return tree.nearest(sample_->clean[i]).squared; });
    const auto n = double(s.count);
    result.chamfer = s.to_clean / n + back / double(sample_->clean.size());
    result.p2s = s.to_surface / n;
    result.p2s_max = std::sqrt(s.largest);
    result.normal = s.angle / n;
    const double mean = s.gap / n;
    result.evenness = std::sqrt(std::max(0.0, s.gap_squared / n - mean * mean)) / mean;
    result.edge_points = s.edge_count;
    result.edge_p2s = s.edge_count == 0 ? 0 : s.at_edges / double(s.edge_count);
  });
  return result;
}

}  // namespace rfsmooth::bench
