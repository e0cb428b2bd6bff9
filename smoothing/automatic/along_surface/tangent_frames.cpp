#include "smoothing/automatic/along_surface/tangent_frames.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "base/avx2.h"
#include "base/linear/small_cholesky.h"
#include "base/parallel.h"
#include "rfs_mesh/connect/ordered_bits.h"
#include "rfs_mesh/fit/plane_normal.h"

namespace rfsmooth::smoothing {

namespace {

using rfs_mesh::kNeighbourhood;

constexpr int kMostRanked = 256;
constexpr std::size_t kPadded = 8;  // keys compared at once

/// row[number of smaller keys] = old, for each of the keys; they are all different.
RFSMOOTH_AVX2 void rank(const std::int32_t* key, const Index* old, std::size_t width, Index* row) {
  typedef std::int32_t Keys __attribute__((vector_size(kPadded * sizeof(std::int32_t))));
  for (std::size_t k = 0; k < width; k += kPadded) {
    Keys own, nearer = {};
    std::memcpy(&own, key + k, sizeof own);
    for (std::size_t j = 0; j < width; ++j) nearer -= key[j] < own;
    for (std::size_t lane = 0; lane < std::min(kPadded, width - k); ++lane)
      row[std::size_t(nearer[lane])] = old[k + lane];
  }
}

/// Brings the nearest to the front of the row, nearer ones first; those equally far up to 1e-5 as they
/// were.
void pick(const Positions& points, const Eigen::Vector3d& p, Index* row, std::size_t width) {
  // The place in the row takes the last eight bits, so no two are equal and counting the smaller ones gives
  // every one a place of its own.
  std::array<std::int32_t, kMostRanked> key;
  std::array<Index, kMostRanked> old;
  for (std::size_t k = 0; k < width; ++k) {
    const auto square = float((points[row[k]] - p).squaredNorm());
    key[k] = std::int32_t(rfs_mesh::ordered_bits(square) & 0xffffff00U) | std::int32_t(k);
    old[k] = row[k];
  }
  for (std::size_t k = width; k % kPadded != 0; ++k) key[k] = std::numeric_limits<std::int32_t>::max();
  rank(key.data(), old.data(), width, row);
}

}  // namespace

NearestRows::NearestRows(rfs_mesh::NeighborTable table, const Positions& points, const Context& context)
    : table_(std::move(table)), normals_(points.size()) {
  if (table_.size() != points.size() || table_.k < int(kNeighbourhood) || table_.k > kMostRanked)
    throw std::invalid_argument("moves along the surface: every point needs 24 to 256 neighbours");
  const auto width = std::size_t(table_.k);
  for_each_index(context, points.size(), [&](std::size_t i) {
    pick(points, points[i], table_.items.data() + i * width, width);
    normals_[i] = rfs_mesh::plane_normal(points, i, (*this)[i]).cast<float>();
  });
}

TangentFrame tangent_frame(const Positions& points, const NearestRows& rows, std::size_t i,
                           TangentNeighbors& around) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  const std::vector<Eigen::Vector3f>& normals = rows.normals();
  const Adjacency::Row near = rows[i];
  TangentFrame f;
  f.n = normals[i];
  f.quadric.setZero();
  f.distance = f.reach = 0;
  f.curved = false;
  const Eigen::Vector3d& p = points[i];
  const double reach = (points[near[near.size() - 1]] - p).norm();
  if (!f.n.allFinite() || !(reach > 0)) return f;
  f.reach = float(reach);
  f.t = f.n.unitOrthogonal();
  f.b = f.n.cross(f.t);
  // n points in a disk of radius r, each with the area of a hexagon: d^2 sqrt(3) / 2 = pi r^2 / n.
  f.distance = float(reach * std::sqrt(2 * M_PI / std::sqrt(3.0) / double(near.size())));
  std::size_t same = 0;
  for (std::size_t k = 0; k < around.u.size(); ++k) {
    const Eigen::Vector3f d = ((points[near[k]] - p) * (1 / reach)).cast<float>();
    around.cosine[k] = std::abs(normals[near[k]].dot(f.n));
    const bool alike = around.cosine[k] >= kSameNormal;
    same += std::size_t(alike);
    around.u[k] = d.dot(f.t);
    around.v[k] = d.dot(f.b);
    around.height[k] = d.dot(f.n);
    around.weight[k] = alike ? float(rfs_mesh::kBeyond) - d.squaredNorm() : 0;
  }
  // The quadric goes through the point: without the constant term.
  QuadricSums sums;
  sum_quadric(around.u.size(), around.u.data(), around.v.data(), around.height.data(), around.weight.data(),
              sums);
  Matrix5 a = sums.a.bottomRightCorner<5, 5>();
  a.diagonal().array() += 1e-9;
  Vector5 quadric = SmallCholesky<5>(a).solve(sums.right.tail<5>());
  quadric.tail<3>() /= reach;
  f.quadric = quadric.cast<float>();
  f.curved = same >= rfs_mesh::kFewestOfQuadric && f.quadric.allFinite();
  return f;
}

}  // namespace rfsmooth::smoothing
