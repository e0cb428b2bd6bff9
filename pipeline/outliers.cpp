#include "rfsmooth/pipeline/outliers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "rfsmooth/rfs_mesh/local_surface.h"
#include "rfsmooth/rfs_mesh/median.h"
#include "rfsmooth/rfs_mesh/neighbors.h"
#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::pipeline {

namespace {

using rfs_mesh::Neighbor;

// Chosen on the development shapes (tests/bench/quality), clean and with noise of up to 4 spacings, with and
// without 1 % strays: none of theirs is called an outlier but one in a million.
constexpr std::size_t kTooFew = 100;  // points: below, nothing is usual
constexpr std::size_t kNear = 8;      // neighbours that say how dense it is
constexpr double kIsolated = 2;       // times the usual reach
constexpr int kKnownBy = 1;           // points that may have an outlier as a neighbour
constexpr std::size_t kPlane = 48;    // points of the plane
constexpr double kSigmas = 5;         // beyond which a point does not belong to the surface
constexpr double kOff = 1.2;          // the same in usual reaches: what a clean surface may curve by
constexpr double kFarOff = 6;         // usual reaches: an outlier wherever the plane is
constexpr int kRounds = 20;           // strays behind strays; three are usual

constexpr double kThin = 4;                     // times the reach of the surface beside floating points
constexpr std::size_t kRegion = 64;             // points among which that surface is
constexpr std::size_t kSurface = kRegion / 10;  // its share of them
constexpr std::size_t kCloud = 24;              // points that fill space or do not
constexpr double kFlat = 0.08;                  // least variance over the sum; 1/3 = a ball
constexpr double kFlatSigmas = 3;               // what noise may fill

/// The plane through some points, by its normal, with their variances along the axes, ascending.
struct Plane {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), normal, variances;
};

Plane fit_plane(const Positions& points, const std::vector<Neighbor>& near) {
  Plane plane;
  for (const Neighbor& q : near) plane.centre += points[q.index];
  plane.centre /= double(near.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Neighbor& q : near) {
    const Eigen::Vector3d d = points[q.index] - plane.centre;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread / double(near.size() - 3));
  plane.normal = solver.eigenvectors().col(0);
  plane.variances = solver.eigenvalues().cwiseMax(0);
  return plane;
}

/// What is not an outlier so far and not isolated: the surfaces.
struct Surfaces {
  Positions points;
  std::vector<Index> row;  ///< of each in the cloud
};

class Search {
 public:
  Search(const Positions& points, const Context& context)
      : points_(points),
        context_(context),
        outlier_(points.size(), 0),
        look_(points.size(), 1),
        reach_(points.size()),
        usual_(points.size()),
        isolated_(points.size()) {
    near_ = rfs_mesh::SpatialIndex(points, context).nearest(int(kNear), context);
    for_each_index(context, points.size(), [&](std::size_t i) { measure_reach(i); });
    std::vector<double> all = reach_;
    median_reach_ = rfs_mesh::median(all);
  }

  std::vector<char> run() {
    for (int round = 0; round < kRounds; ++round) {
      context_.report("outliers", double(round) / kRounds);
      if (!find(round > 0)) break;
      for_each_index(context_, points_.size(), [&](std::size_t i) {
        look_[i] = 0;
        if (outlier_[i] == 0)
          for (const Index j : near_[i]) look_[i] |= outlier_[j];
      });
    }
    return std::move(outlier_);
  }

 private:
  void measure_reach(std::size_t i) { reach_[i] = (points_[near_[i][kNear - 1]] - points_[i]).norm(); }

  void measure_isolation() {
    for_each_index(context_, points_.size(), [&](std::size_t i) {
      std::array<double, kNear> around = {};
      for (std::size_t k = 0; k < kNear; ++k) around[k] = reach_[near_[i][k]];
      std::nth_element(around.begin(), around.begin() + kNear / 4, around.end());
      usual_[i] = around[kNear / 4];
      isolated_[i] = reach_[i] > kIsolated * usual_[i];
    });
  }

  Surfaces surfaces() const {
    Surfaces s;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (outlier_[i] != 0 || isolated_[i] != 0) continue;
      s.points.push_back(points_[i]);
      s.row.push_back(Index(i));
    }
    return s;
  }

  /// New neighbours, on the surfaces, of the points that have an outlier among theirs.
  void measure_again(const Surfaces& s, const rfs_mesh::SpatialIndex& index) {
    for_blocks(context_, points_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbor> around;
      for (std::size_t i = begin; i < end; ++i) {
        if (look_[i] == 0) continue;
        index.nearest(points_[i], int(kNear) + 1, around);
        Index* row = near_.items.data() + i * kNear;
        for (std::size_t k = 0, to = 0; to < kNear; ++k)
          if (s.row[around[k].index] != i) row[to++] = s.row[around[k].index];
        measure_reach(i);
      }
    });
    measure_isolation();
  }

  std::vector<int> known_by() const {
    std::vector<int> known(points_.size(), 0);
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (outlier_[i] == 0 && isolated_[i] == 0)
        for (const Index j : near_[i]) ++known[j];
    return known;
  }

  /// One round; returns whether it found any.
  bool find(bool again) {
    measure_isolation();
    const Surfaces s = surfaces();
    if (s.points.size() < kTooFew) return false;
    const rfs_mesh::SpatialIndex index(s.points, context_);
    if (again)
      measure_again(s, index);
    else
      noise_ = rfs_mesh::noise_scale(index, context_);
    const std::vector<int> known = known_by();
    std::vector<char> found(points_.size(), 0);
    for_blocks(context_, points_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbor> around;
      for (std::size_t i = begin; i < end; ++i) {
        if (look_[i] == 0) continue;
        if (isolated_[i] != 0 && known[i] <= kKnownBy)
          found[i] = has_no_surface(index, i, around);
        else
          found[i] = floats(s, index, i, around);
      }
    });
    bool any = false;
    for (std::size_t i = 0; i < found.size(); ++i) {
      outlier_[i] |= found[i];
      any = any || found[i] != 0;
    }
    return any;
  }

  bool has_no_surface(const rfs_mesh::SpatialIndex& index, std::size_t i,
                      std::vector<Neighbor>& around) const {
    if (reach_[i] > kFarOff * usual_[i]) return true;
    const Positions& points = index.points();
    index.nearest(points_[i], 1, around);
    index.nearest(points[around.front().index], int(std::max(kPlane, noise_.neighbours)), around);
    const Plane plane = fit_plane(points, around);
    const double off = std::abs(plane.normal.dot(points_[i] - plane.centre));
    return off > kOff * usual_[i] && off > kSigmas * std::max(std::sqrt(plane.variances[0]), noise_.sigma);
  }

  bool floats(const Surfaces& s, const rfs_mesh::SpatialIndex& index, std::size_t i,
              std::vector<Neighbor>& around) const {
    if (!(reach_[i] > kThin * median_reach_)) return false;
    index.nearest(points_[i], int(kRegion), around);
    std::array<double, kRegion> reaches = {};
    for (std::size_t k = 0; k < kRegion; ++k) reaches[k] = reach_[s.row[around[k].index]];
    std::nth_element(reaches.begin(), reaches.begin() + kSurface, reaches.end());
    if (!(reach_[i] > kThin * reaches[kSurface])) return false;
    around.resize(kCloud);
    const Eigen::Vector3d variances = fit_plane(s.points, around).variances;
    return variances[0] > kFlat * variances.sum() && std::sqrt(variances[0]) > kFlatSigmas * noise_.sigma;
  }

  const Positions& points_;
  const Context& context_;
  std::vector<char> outlier_, look_;
  rfs_mesh::NeighborTable near_;
  std::vector<double> reach_;  ///< to the 8th neighbour
  std::vector<double> usual_;  ///< the lower quartile of the neighbours' reaches
  std::vector<char> isolated_;
  double median_reach_ = 0;
  rfs_mesh::NoiseScale noise_;
};

}  // namespace

std::vector<char> find_outliers(const Positions& points, const Context& context) {
  if (points.size() < kTooFew) return std::vector<char>(points.size(), 0);
  return Search(points, context).run();
}

}  // namespace rfsmooth::pipeline
