#include "smoothing/automatic/equalize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "base/avx2.h"
#include "base/linear/small_cholesky.h"
#include "base/parallel.h"
#include "base/raw_array.h"
#include "rfs_mesh/fit/plane_normal.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/patches/fit/quadric_sums.h"

namespace rfsmooth::smoothing {

namespace {

using rfs_mesh::kNeighbourhood;

// Chosen on the development shapes (tests/bench/quality).
constexpr std::size_t kPushers = 12;  // neighbours that push
constexpr float kReach = 1.9F;        // R in local distances between points
constexpr double kGain = 0.4;         // step / (sigma/d)^2, in R f
constexpr double kStep = 0.3;         // the longest
constexpr int kSteps = 6;
constexpr double kMostMove = 0.5 * (1 - 1e-6);  // of the local distance; single precision rounds
constexpr float kSameNormal = 0.85F;            // cosine: a neighbour beyond it means an edge
constexpr float kMostRise = 0.3F;  // of the way along the surface: a quadric is not to be trusted beyond
constexpr double kShare = 0.75;    // of the tangential offset that is given back at little noise; the rims of
constexpr double kShareUpTo = 1.6;  // open sheets want it up to this many sigma per spacing
constexpr double kWidestGap = 2.4;  // radians between neighbours' directions: wider means a rim

/// A point's surface: x(u, v) = p + u t + v b + (c1 u + c2 v + c3 u^2 + c4 u v + c5 v^2) n. In single
/// precision: it only gives moves, which are short.
struct Frame {
  Eigen::Vector3f t, b, n;
  Eigen::Matrix<float, 5, 1> quadric;
  float distance;  ///< between points near here, as on a hexagonal grid; 0: no frame
  bool movable, rim, slides;
  Eigen::Vector2f along;  ///< the edge that a sliding point stays beside, unit

  /// The part along the surface; 0 where there is none.
  Eigen::Vector2f offset(const Eigen::Vector3f& d) const {
    return distance > 0 ? Eigen::Vector2f(d.dot(t), d.dot(b)) : Eigen::Vector2f(0, 0);
  }
  /// p moved by m: over the quadric where there is one, but rising by no more than a share of the way.
  Eigen::Vector3d slide(const Eigen::Vector3d& p, const Eigen::Vector2f& m) const {
    if (!(distance > 0)) return p;
    const float u = m.x(), v = m.y(), most = kMostRise * m.norm();
    const float rise =
        movable ? u * (quadric[0] + u * quadric[2] + v * quadric[3]) + v * (quadric[1] + v * quadric[4]) : 0;
    return p + (u * t + v * b + std::clamp(rise, -most, most) * n).cast<double>();
  }
};

/// The neighbours of a point in its frame, by axis, in units of the farthest.
struct Around {
  static_assert(kNeighbourhood % kLanes == 0);
  std::array<float, kNeighbourhood> u, v, height, weight;
  std::array<float, kNeighbourhood> cosine;  ///< between the normals
};

/// Whether there is a neighbour in each of the six sectors of 60 degrees: nearly always.
bool all_around(const Around& around) {
  constexpr std::size_t kFour = 4;
  typedef float Floats __attribute__((vector_size(kFour * sizeof(float))));
  typedef std::int32_t Flags __attribute__((vector_size(kFour * sizeof(std::int32_t))));
  const float root = std::sqrt(3.0F);
  Flags found[6] = {};
  for (std::size_t k = 0; k < around.u.size(); k += kFour) {
    Floats u, v;
    std::memcpy(&u, around.u.data() + k, sizeof u);
    std::memcpy(&v, around.v.data() + k, sizeof v);
    const Floats slope = root * u;
    const Flags below = v < 0, ahead = below ? slope > -v : slope > v,
                behind = below ? -slope > -v : -slope > v;
    found[0] |= ahead & ~below;
    found[1] |= ~(ahead | behind | below);
    found[2] |= behind & ~below;
    found[3] |= ahead & below;
    found[4] |= ~(ahead | behind) & below;
    found[5] |= behind & below;
  }
  bool all = true;
  for (const Flags& f : found) all &= (f[0] | f[1] | f[2] | f[3]) != 0;
  return all;
}

/// Whether the directions to the nearest neighbours leave no wide gap.
bool surrounded(const Around& around) {
  // A neighbour in each sector leaves no gap of 120 degrees.
  static_assert(kWidestGap > 2 * M_PI / 3);
  if (all_around(around)) return true;
  std::array<double, kNeighbourhood> angles = {};
  for (std::size_t k = 0; k < angles.size(); ++k)
    angles[k] = std::atan2(double(around.v[k]), double(around.u[k]));
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2 * M_PI - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) widest = std::max(widest, angles[k] - angles[k - 1]);
  return widest < kWidestGap;
}

/// The kNeighbourhood nearest of every point.
class Near {
 public:
  /// Picks them out of the rows of a table, in place. Also makes the normals of their planes.
  Near(rfs_mesh::NeighborTable table, const Positions& points, std::vector<Eigen::Vector3f>& normals,
       const Context& context)
      : table_(std::move(table)) {
    if (table_.size() != points.size() || table_.k < int(kNeighbourhood) || table_.k > kMostRanked)
      throw std::invalid_argument("equalize: every point needs 24 to 256 neighbours");
    normals.resize(points.size());
    const auto width = std::size_t(table_.k);
    for_each_index(context, points.size(), [&](std::size_t i) {
      pick(points, points[i], table_.items.data() + i * width, width);
      normals[i] = rfs_mesh::plane_normal(points, i, (*this)[i]).cast<float>();
    });
  }

  Adjacency::Row operator[](std::size_t i) const {
    const Index* const first = table_.items.data() + i * std::size_t(table_.k);
    return {first, first + kNeighbourhood};
  }

 private:
  static constexpr int kMostRanked = 256;
  static constexpr std::size_t kPadded = 8;  // keys compared at once

  /// Brings the nearest to the front of the row, nearer ones first; those equally far up to 1e-5 as they
  /// were.
  static void pick(const Positions& points, const Eigen::Vector3d& p, Index* row, std::size_t width) {
    // The bits of positive numbers are in the order of the numbers. The place in the row takes the last
    // eight, so no two are equal and counting the smaller ones gives every one a place of its own.
    std::array<std::int32_t, kMostRanked> key;
    std::array<Index, kMostRanked> old;
    for (std::size_t k = 0; k < width; ++k) {
      const auto square = float((points[row[k]] - p).squaredNorm());
      std::memcpy(&key[k], &square, sizeof square);
      key[k] = std::int32_t(std::uint32_t(key[k]) & 0xffffff00U) | std::int32_t(k);
      old[k] = row[k];
    }
    for (std::size_t k = width; k % kPadded != 0; ++k) key[k] = std::numeric_limits<std::int32_t>::max();
    rank(key.data(), old.data(), width, row);
  }

  /// row[number of smaller keys] = old, for each of the keys; they are all different.
  RFSMOOTH_AVX2 static void rank(const std::int32_t* key, const Index* old, std::size_t width, Index* row) {
    typedef std::int32_t Keys __attribute__((vector_size(kPadded * sizeof(std::int32_t))));
    for (std::size_t k = 0; k < width; k += kPadded) {
      Keys own, nearer = {};
      std::memcpy(&own, key + k, sizeof own);
      for (std::size_t j = 0; j < width; ++j) nearer -= key[j] < own;
      for (std::size_t lane = 0; lane < std::min(kPadded, width - k); ++lane)
        row[std::size_t(nearer[lane])] = old[k + lane];
    }
  }

  rfs_mesh::NeighborTable table_;
};

Frame open_frame(const Positions& points, const std::vector<Eigen::Vector3f>& normals, std::size_t i,
                 Adjacency::Row near, Around& around) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  Frame f;
  f.n = normals[i];
  f.quadric.setZero();
  f.distance = 0;
  f.movable = f.rim = f.slides = false;
  f.along.setZero();
  const Eigen::Vector3d& p = points[i];
  const double reach = (points[near[near.size() - 1]] - p).norm();
  if (!f.n.allFinite() || !(reach > 0)) return f;
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
    around.weight[k] = alike ? 1.1F - d.squaredNorm() : 0;
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
  f.movable = same >= rfs_mesh::kFewestOfQuadric && f.quadric.allFinite();
  return f;
}

/// The frame of a point to be pushed: whether it may move, and how.
Frame make_frame(const Positions& points, const std::vector<Eigen::Vector3f>& normals, std::size_t i,
                 Adjacency::Row near) {
  Around around;
  Frame f = open_frame(points, normals, i, near, around);
  if (!(f.distance > 0)) return f;
  f.rim = !surrounded(around);
  if (f.rim) f.movable = false;
  // Beside an edge the points beyond it push harder than those on this side, being nearer through the air.
  float least = kSameNormal;
  for (std::size_t k = 0; k < kPushers; ++k) {
    const float cosine = around.cosine[k];
    if (cosine < float(rfs_mesh::kSameSheet)) f.movable = false;  // on the edge
    if (cosine >= least) continue;
    least = cosine;
    const Eigen::Vector3f edge = f.n.cross(normals[near[k]]);
    f.along = Eigen::Vector2f(edge.dot(f.t), edge.dot(f.b)).normalized();
    f.slides = true;
  }
  return f;
}

/// What the neighbours nearer than `reach` push p by, all side by side and without a branch: most pairs are
/// near the limit.
Eigen::Vector3f push(const Positions& points, const Eigen::Vector3d& p, const Index* near, float reach) {
  using Lanes = Eigen::Array<float, int(kPushers), 1>;
  Lanes x, y, z;
  for (std::size_t k = 0; k < kPushers; ++k) {
    const Eigen::Vector3d& q = points[near[k]];
    x[Eigen::Index(k)] = float(p[0] - q[0]);
    y[Eigen::Index(k)] = float(p[1] - q[1]);
    z[Eigen::Index(k)] = float(p[2] - q[2]);
  }
  const Lanes length = (x * x + y * y + z * z).sqrt().max(std::numeric_limits<float>::min());
  const Lanes overlap = (1 - length * (1 / reach)).max(0), force = overlap * overlap / length;
  return {(force * x).sum(), (force * y).sum(), (force * z).sum()};
}

}  // namespace

void slide_back(Positions& points, const Positions& before, double share, rfs_mesh::NeighborTable table,
                const Context& context) {
  const std::size_t n = points.size();
  if (n <= kNeighbourhood) return;
  std::vector<Eigen::Vector3f> normals;
  const Near near(std::move(table), points, normals, context);
  Positions back(n);
  for_each_index(context, n, [&](std::size_t i) {
    Around around;
    const Frame f = open_frame(points, normals, i, near[i], around);
    back[i] = f.slide(points[i], float(share) * f.offset((before[i] - points[i]).cast<float>()));
  });
  points = std::move(back);
}

Equalized equalize(Positions& points, const Positions& before, const rfs_mesh::NoiseField& noise,
                   rfs_mesh::NeighborTable table, const Context& context) {
  const std::size_t n = points.size();
  if (n <= kNeighbourhood) return {};
  std::vector<Eigen::Vector3f> normals;
  const Near near(std::move(table), points, normals, context);
  RawArray<Frame> frames(n);
  for_each_index(context, n, [&](std::size_t i) { frames[i] = make_frame(points, normals, i, near[i]); });
  std::vector<Eigen::Vector3f>().swap(normals);

  // Beside a rim the pushes from outside are missing too: points there stay as well.
  std::vector<char> inside(n);
  for_each_index(context, n, [&](std::size_t i) {
    inside[i] = frames[i].movable;
    for (std::size_t k = 0; k < kPushers; ++k) inside[i] &= char(!frames[near[i][k]].rim);
  });

  Positions now(n);
  std::vector<Eigen::Vector2f> start(n), moved(n, Eigen::Vector2f::Zero());
  for_each_index(context, n, [&](std::size_t i) {
    const double calm = std::min(1.0, noise.local[i] / noise.sigma),
                 much = noise.local[i] / (kShareUpTo * noise.spacing);
    const auto given_back = float((1 - (1 - kShare) * calm * calm) / (1 + much * much * much * much));
    start[i] = given_back * frames[i].offset((before[i] - points[i]).cast<float>());
    now[i] = frames[i].slide(points[i], start[i]);
  });
  Positions next = now;  // points that stay are the same in both
  for (int step = 0; step < kSteps; ++step) {
    for_each_index(context, n, [&](std::size_t i) {
      const Frame& f = frames[i];
      if (!inside[i]) return;
      const float reach = kReach * f.distance;
      Eigen::Vector2f force = f.offset(push(now, now[i], near[i].begin(), reach));
      if (f.slides) force = f.along * f.along.dot(force);
      const double share = noise.local[i] / double(f.distance);
      moved[i] += float(std::min(kStep, kGain * share * share)) * reach * force;
      const auto limit = float(kMostMove * std::min(double(f.distance), noise.spacing));
      if (const float length = moved[i].norm(); length > limit) moved[i] *= limit / length;
      next[i] = f.slide(points[i], start[i] + moved[i]);
    });
    now.swap(next);
  }
  points = std::move(now);
  Equalized done;
  done.rms = std::sqrt(
      sum_over(context, n, 0.0, [&](std::size_t i) { return double(moved[i].squaredNorm()); }) / double(n));
  done.largest = reduce_blocks(
      context, n, 0.0,
      [&](std::size_t begin, std::size_t end) {
        float largest = 0;
        for (std::size_t i = begin; i < end; ++i) largest = std::max(largest, moved[i].norm());
        return double(largest);
      },
      [](double a, double b) { return std::max(a, b); });
  return done;
}

}  // namespace rfsmooth::smoothing
