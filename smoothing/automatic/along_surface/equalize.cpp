#include "smoothing/automatic/along_surface/equalize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "base/raw_array.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/along_surface/tangent_frames.h"

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
constexpr double kShare = 0.75;                 // of the tangential offset that is given back at little noise
constexpr double kShareUpTo = 1.6;  // sigma per spacing: up to so much the rims of open sheets want it back
constexpr double kWidestGap = 2.4;  // radians between neighbours' directions: wider means a rim

/// Whether there is a neighbour in each of the six sectors of 60 degrees: nearly always.
bool all_around(const TangentNeighbors& around) {
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
bool surrounded(const TangentNeighbors& around) {
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

/// The frame of a point to be pushed.
struct PushFrame : TangentFrame {
  bool rim = false, slides = false;
  Eigen::Vector2f along = Eigen::Vector2f::Zero();  ///< the edge that a sliding point stays beside, unit
};

/// Whether a point may be pushed, and how: at rims and on edges it is not, and its quadric does not count.
PushFrame make_frame(const Positions& points, const NearestRows& near, std::size_t i) {
  TangentNeighbors around;
  PushFrame f{tangent_frame(points, near, i, around)};
  if (!(f.distance > 0)) return f;
  f.rim = !surrounded(around);
  if (f.rim) f.curved = false;
  // Beside an edge the points beyond it push harder than those on this side, being nearer through the air.
  float least = kSameNormal;
  for (std::size_t k = 0; k < kPushers; ++k) {
    const float cosine = around.cosine[k];
    if (cosine < float(rfs_mesh::kSameSheet)) f.curved = false;  // on the edge
    if (cosine >= least) continue;
    least = cosine;
    const Eigen::Vector3f edge = f.n.cross(near.normals()[near[i][k]]);
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

Equalized equalize(Positions& points, const Positions& before, const rfs_mesh::NoiseField& noise,
                   rfs_mesh::NeighborTable table, const Context& context) {
  const std::size_t n = points.size();
  if (n <= kNeighbourhood) return {};
  NearestRows near(std::move(table), points, context);
  RawArray<PushFrame> frames(n);
  for_each_index(context, n, [&](std::size_t i) { frames[i] = make_frame(points, near, i); });
  near.drop_normals();

  // Beside a rim the pushes from outside are missing too: points there stay as well.
  std::vector<char> inside(n);
  for_each_index(context, n, [&](std::size_t i) {
    inside[i] = frames[i].curved;
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
      const PushFrame& f = frames[i];
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
