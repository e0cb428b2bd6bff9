#include "rfsmooth/smoothing/equalize.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/smoothing/plane_normal.h"

namespace rfsmooth::smoothing {

namespace {

// Chosen on the development shapes (tests/bench/quality).
constexpr int kNear = 24;             // neighbours of the frame and its quadric
constexpr std::size_t kPushers = 12;  // neighbours that push
constexpr double kReach = 1.9;        // R in local distances between points
constexpr double kGain = 0.4;         // step / (sigma/d)^2, in R f
constexpr double kStep = 0.3;         // the longest
constexpr int kSteps = 6;
constexpr double kMost = 0.5;  // of the local distance
constexpr double kMostSigmas = 0.7;
constexpr double kSameNormal = 0.85;  // cosine: a neighbour beyond it means an edge
constexpr double kEdgeNormal = 0.6;   // cosine: the same, so near that the point stays
constexpr std::size_t kFewest = 10;   // points of the quadric, twice its unknowns
constexpr double kMostRise = 0.3;     // of the way along the surface: a quadric is not to be trusted beyond
constexpr double kShare = 0.75;  // of the tangential offset that is given back at little noise; the rims of
constexpr double kShareUpTo = 1.6;  // open sheets want it up to this many sigma per spacing
constexpr double kWidestGap = 2.4;  // radians between neighbours' directions: wider means a rim

/// A point's surface: x(u, v) = p + u t + v b + (c3 u^2 + c4 u v + c5 v^2 + c1 u + c2 v) n.
struct Frame {
  Eigen::Vector3d t, b, n;
  Eigen::Matrix<double, 5, 1> quadric = Eigen::Matrix<double, 5, 1>::Zero();
  double distance = 0;  ///< between points near here, as on a hexagonal grid
  bool movable = false, rim = false, slides = false;
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  ///< the edge that a sliding point stays beside, unit

  /// The part along the surface; 0 where there is none.
  Eigen::Vector2d offset(const Eigen::Vector3d& d) const {
    return distance > 0 ? Eigen::Vector2d(d.dot(t), d.dot(b)) : Eigen::Vector2d(0, 0);
  }
  /// p moved by m: over the quadric where there is one, but rising by no more than a share of the way.
  Eigen::Vector3d slide(const Eigen::Vector3d& p, const Eigen::Vector2d& m) const {
    if (!(distance > 0)) return p;
    const double u = m.x(), v = m.y(), most = kMostRise * m.norm();
    const double rise = movable ? quadric[0] * u + quadric[1] * v + quadric[2] * u * u + quadric[3] * u * v +
                                      quadric[4] * v * v
                                : 0;
    return p + u * t + v * b + std::clamp(rise, -most, most) * n;
  }
};

/// Whether the directions to the nearest neighbours leave no wide gap.
bool surrounded(const Frame& f, const Positions& points, std::size_t i, rfs_mesh::Adjacency::Row near) {
  std::array<double, kNear> u = {}, v = {};
  unsigned sectors = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const Eigen::Vector3d d = points[near[k]] - points[i];
    u[k] = d.dot(f.t);
    v[k] = d.dot(f.b);
    // Sectors of 60 degrees, numbered anticlockwise: a neighbour in each of the six leaves no gap of 120, and
    // that is nearly always so.
    const double slope = std::sqrt(3.0) * u[k], height = std::abs(v[k]);
    const unsigned from_axis = slope > height ? 0 : -slope > height ? 2 : 1;
    sectors |= 1U << (v[k] < 0 ? 5 - from_axis : from_axis);
  }
  static_assert(kWidestGap > 2 * M_PI / 3);
  if (sectors == 0x3f) return true;
  std::array<double, kNear> angles = {};
  for (std::size_t k = 0; k < angles.size(); ++k) angles[k] = std::atan2(v[k], u[k]);
  std::sort(angles.begin(), angles.end());
  double widest = angles.front() + 2 * M_PI - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) widest = std::max(widest, angles[k] - angles[k - 1]);
  return widest < kWidestGap;
}

std::vector<Eigen::Vector3d> plane_normals(const Positions& points, const rfs_mesh::NeighborTable& near,
                                           const Context& context) {
  std::vector<Eigen::Vector3d> normals(points.size());
  for_each_index(context, points.size(),
                 [&](std::size_t i) { normals[i] = plane_normal(points, i, near[i]); });
  return normals;
}

Frame open_frame(const Positions& points, const std::vector<Eigen::Vector3d>& normals, std::size_t i,
                 rfs_mesh::Adjacency::Row near) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  Frame f;
  f.n = normals[i];
  const double reach = (points[near[near.size() - 1]] - points[i]).norm();
  if (!f.n.allFinite() || !(reach > 0)) return f;
  f.t = f.n.unitOrthogonal();
  f.b = f.n.cross(f.t);
  // n points in a disk of radius r, each with the area of a hexagon: d^2 sqrt(3) / 2 = pi r^2 / n.
  f.distance = reach * std::sqrt(2 * M_PI / std::sqrt(3.0) / double(near.size()));
  Matrix5 a = Matrix5::Zero();
  Vector5 right = Vector5::Zero();
  std::size_t same = 0;
  for (const Index j : near) {
    const Eigen::Vector3d d = (points[j] - points[i]) / reach;
    if (std::abs(normals[j].dot(f.n)) < kSameNormal) continue;
    ++same;
    const double u = d.dot(f.t), v = d.dot(f.b), w = 1.1 - d.squaredNorm();
    const Vector5 g = (Vector5() << u, v, u * u, u * v, v * v).finished();
    a += w * g * g.transpose();
    right += w * d.dot(f.n) * g;
  }
  a.diagonal().array() += 1e-9;
  f.quadric = a.llt().solve(right);
  f.quadric.tail<3>() /= reach;
  f.movable = same >= kFewest && f.quadric.allFinite();
  return f;
}

/// The frame of a point to be pushed: whether it may move, and how.
Frame make_frame(const Positions& points, const std::vector<Eigen::Vector3d>& normals, std::size_t i,
                 rfs_mesh::Adjacency::Row near) {
  Frame f = open_frame(points, normals, i, near);
  if (!(f.distance > 0)) return f;
  f.rim = !surrounded(f, points, i, near);
  if (f.rim) f.movable = false;
  // Beside an edge the points beyond it push harder than those on this side, being nearer through the air.
  double least = kSameNormal;
  for (std::size_t k = 0; k < kPushers; ++k) {
    const double cosine = std::abs(normals[near[k]].dot(f.n));
    if (cosine < kEdgeNormal) f.movable = false;
    if (cosine >= least) continue;
    least = cosine;
    const Eigen::Vector3d edge = f.n.cross(normals[near[k]]);
    f.along = Eigen::Vector2d(edge.dot(f.t), edge.dot(f.b)).normalized();
    f.slides = true;
  }
  return f;
}

}  // namespace

void slide_back(Positions& points, const Positions& before, double share, const Context& context) {
  const std::size_t n = points.size();
  if (n <= std::size_t(kNear)) return;
  const rfs_mesh::NeighborTable near = rfs_mesh::SpatialIndex(points, context).nearest(kNear, context);
  const std::vector<Eigen::Vector3d> normals = plane_normals(points, near, context);
  Positions back(n);
  for_each_index(context, n, [&](std::size_t i) {
    const Frame f = open_frame(points, normals, i, near[i]);
    back[i] = f.slide(points[i], share * f.offset(before[i] - points[i]));
  });
  points = std::move(back);
}

Equalized equalize(Positions& points, const Positions& before, double sigma, double spacing,
                   const Context& context) {
  const std::size_t n = points.size();
  if (n <= std::size_t(kNear) || !(sigma > 0)) return {};
  const rfs_mesh::NeighborTable near = rfs_mesh::SpatialIndex(points, context).nearest(kNear, context);
  const std::vector<Eigen::Vector3d> normals = plane_normals(points, near, context);
  std::vector<Frame> frames(n);
  for_each_index(context, n, [&](std::size_t i) { frames[i] = make_frame(points, normals, i, near[i]); });

  // Beside a rim the pushes from outside are missing too: points there stay as well.
  std::vector<char> inside(n);
  for_each_index(context, n, [&](std::size_t i) {
    inside[i] = frames[i].movable;
    for (std::size_t k = 0; k < kPushers; ++k) inside[i] &= char(!frames[near[i][k]].rim);
  });

  const double noise = sigma / (kShareUpTo * spacing),
               given_back = kShare / (1 + noise * noise * noise * noise);
  Positions now(n);
  std::vector<Eigen::Vector2d> start(n), moved(n, Eigen::Vector2d::Zero());
  for_each_index(context, n, [&](std::size_t i) {
    start[i] = given_back * frames[i].offset(before[i] - points[i]);
    now[i] = frames[i].slide(points[i], start[i]);
  });
  Positions next = now;
  for (int step = 0; step < kSteps; ++step) {
    for_each_index(context, n, [&](std::size_t i) {
      const Frame& f = frames[i];
      if (!inside[i]) return;
      const double reach = kReach * f.distance;
      Eigen::Vector2d force = Eigen::Vector2d::Zero();
      for (std::size_t k = 0; k < kPushers; ++k) {
        const Eigen::Vector3d d = now[i] - now[near[i][k]];
        const double length = d.norm();
        if (!(length > 0) || length >= reach) continue;
        const double overlap = 1 - length / reach;
        force += overlap * overlap / length * Eigen::Vector2d(d.dot(f.t), d.dot(f.b));
      }
      if (f.slides) force = f.along * f.along.dot(force);
      const double share = sigma / f.distance;
      moved[i] += std::min(kStep, kGain * share * share) * reach * force;
      const double limit = std::min(kMost * std::min(f.distance, spacing), kMostSigmas * sigma);
      if (const double length = moved[i].norm(); length > limit) moved[i] *= limit / length;
      next[i] = f.slide(points[i], start[i] + moved[i]);
    });
    now.swap(next);
    next = now;
  }
  points = std::move(now);
  Equalized done;
  done.rms =
      std::sqrt(sum_over(context, n, 0.0, [&](std::size_t i) { return moved[i].squaredNorm(); }) / double(n));
  for (const Eigen::Vector2d& m : moved) done.largest = std::max(done.largest, m.norm());
  return done;
}

}  // namespace rfsmooth::smoothing
