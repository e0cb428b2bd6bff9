#include "pipeline/outliers.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/fit/principal_axes.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/noise/noise.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

namespace {

using rfs_mesh::kNeighbourhood;
using rfs_mesh::kRing;
using rfs_mesh::Neighbor;

// Chosen on the development shapes (tests/bench/quality), clean and with noise of up to 4 spacings, with and
// without 1 % strays: none of theirs is called an outlier but one in a million.
constexpr double kIsolated = 2;                     // times the usual reach
constexpr int kKnownBy = 1;                         // points that may have an outlier as a neighbour
constexpr std::size_t kPlane = 2 * kNeighbourhood;  // points of the plane
constexpr double kOff = 1.2;   // usual reaches off the surface: what a clean surface may curve by
constexpr double kFarOff = 6;  // usual reaches: an outlier wherever the plane is

// Times the reach of the surface beside floating points: isolated even from isolated ones.
constexpr double kThin = kIsolated * kIsolated;
constexpr std::size_t kRegion = 64;  // points among which that surface has a ring; in fewer, nothing is usual
constexpr double kFlat = 0.08;       // least variance over the sum; 1/3 = a ball

/// The plane through some points, by its normal, with their variances along the axes, ascending.
struct Plane {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero(),
                  variances = Eigen::Vector3d::Zero();
};

/// Zero all over if the points are three or fewer, which lie on a plane whatever they are: nothing is off it.
Plane fit_plane(const Positions& points, const std::vector<Neighbor>& near) {
  constexpr std::size_t kOnAnyPlane = 3;
  Plane plane;
  if (near.size() <= kOnAnyPlane) return plane;
  const auto [mean, axes] = rfs_mesh::principal_axes(points, near);
  plane.centre = mean;
  plane.normal = axes.vectors.col(0);
  plane.variances = axes.values.cwiseMax(0) / double(near.size() - kOnAnyPlane);
  return plane;
}

class Search {
 public:
  /// \param near rows of kRing \param sigma of the noise; 0: as little as the points about a place scatter
  Search(const rfs_mesh::SpatialIndex& index, rfs_mesh::NeighborTable near, double sigma,
         std::optional<double>& reach, const Context& context)
      : index_(index),
        points_(index.points()),
        context_(context),
        outlier_(points_.size(), 0),
        look_(points_.size(), 1),
        reach_(points_.size()),
        usual_(points_.size()),
        isolated_(points_.size()),
        near_(std::move(near)),
        sigma_(sigma) {
    for_each_index(context, points_.size(), [&](std::size_t i) { measure_reach(i); });
    if (!reach) {
      std::vector<double> all = reach_;
      reach = rfsmooth::median(all);
    }
    median_reach_ = *reach;
    for_each_index(context, points_.size(), [&](std::size_t i) { measure_isolation(i); });
  }

  std::vector<char> run() {
    for (int round = 0;; ++round) {
      context_.report("outliers", 1 - 1 / (1 + 0.5 * double(round)));  // three rounds are usual
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
  void measure_reach(std::size_t i) { reach_[i] = (points_[near_[i][kRing - 1]] - points_[i]).norm(); }

  void measure_isolation(std::size_t i) {
    std::array<double, kRing / 4 + 1> least = {};
    least.fill(std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < kRing; ++k) {
      double reach = reach_[near_[i][k]];
      for (double& kept : least) {  // no branches: which is less is anyone's guess
        const double lower = reach < kept ? reach : kept;
        reach = reach < kept ? kept : reach;
        kept = lower;
      }
    }
    usual_[i] = least.back();
    isolated_[i] = reach_[i] > kIsolated * usual_[i];
  }

  /// What is not an outlier so far and not isolated is a surface.
  bool on_surface(Index i) const { return outlier_[i] == 0 && isolated_[i] == 0; }

  /// The k nearest points of the surfaces, ascending.
  void nearest_on_surface(const Eigen::Vector3d& at, std::size_t k, std::vector<Neighbor>& around) const {
    for (std::size_t asked = k + k / 8 + 1;; asked *= 2) {
      index_.nearest(at, int(asked), around);
      const bool all = around.size() < asked;
      around.erase(std::remove_if(around.begin(), around.end(),
                                  [&](const Neighbor& q) { return !on_surface(q.index); }),
                   around.end());
      if (!all && around.size() < k) continue;
      around.resize(std::min(k, around.size()));
      return;
    }
  }

  /// New neighbours, on the surfaces, of the points that have an outlier among theirs.
  void measure_again() {
    for_blocks(context_, points_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbor> around;
      for (std::size_t i = begin; i < end; ++i) {
        if (look_[i] == 0) continue;
        nearest_on_surface(points_[i], kRing + 1, around);
        Index* row = near_.items.data() + i * kRing;
        for (std::size_t k = 0, to = 0; to < kRing; ++k)
          if (around[k].index != i) row[to++] = around[k].index;
        measure_reach(i);
      }
    });
    for_each_index(context_, points_.size(), [&](std::size_t i) {
      const auto row = near_[i];
      if (look_[i] != 0 || std::any_of(row.begin(), row.end(), [&](Index j) { return look_[j] != 0; }))
        measure_isolation(i);
    });
  }

  /// For isolated points: who on the surfaces has them among their own.
  std::vector<std::atomic<int>> known_by() const {
    std::vector<std::atomic<int>> known(points_.size());
    for_each_index(context_, points_.size(), [&](std::size_t i) {
      if (!on_surface(Index(i))) return;
      for (const Index j : near_[i])
        if (isolated_[j] != 0) known[j].fetch_add(1, std::memory_order_relaxed);
    });
    return known;
  }

  /// One round; returns whether it found any.
  bool find(bool again) {
    const auto surface = sum_over(context_, points_.size(), std::size_t{0},
                                  [&](std::size_t i) { return std::size_t(on_surface(Index(i))); });
    if (surface < kRegion) return false;
    if (again) measure_again();
    const auto known = known_by();
    std::vector<char> found(points_.size(), 0);
    for_blocks(context_, points_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbor> around;
      for (std::size_t i = begin; i < end; ++i) {
        if (look_[i] == 0) continue;
        if (isolated_[i] != 0 && known[i] <= kKnownBy)
          found[i] = has_no_surface(i, around);
        else
          found[i] = floats(i, around);
      }
    });
    bool any = false;
    for (std::size_t i = 0; i < found.size(); ++i) {
      outlier_[i] |= found[i];
      any = any || found[i] != 0;
    }
    return any;
  }

  /// The plane of a surface through kPlane points, or as many as a ball has that holds the slab of noise.
  Plane plane_at(const Eigen::Vector3d& at, std::vector<Neighbor>& around) const {
    const double holds = sigma_ / rfs_mesh::kFlatSlab;
    for (std::size_t k = kPlane;; k *= 2) {
      nearest_on_surface(at, k, around);
      if (around.size() < k || around.back().squared_distance >= holds * holds) break;
    }
    return fit_plane(points_, around);
  }

  bool has_no_surface(std::size_t i, std::vector<Neighbor>& around) const {
    if (reach_[i] > kFarOff * usual_[i]) return true;
    nearest_on_surface(points_[i], 1, around);
    if (around.empty()) return false;
    const Plane plane = plane_at(points_[around.front().index], around);
    const double off = std::abs(plane.normal.dot(points_[i] - plane.centre));
    return off > kOff * usual_[i] && off > rfs_mesh::kStray * std::max(std::sqrt(plane.variances[0]), sigma_);
  }

  bool floats(std::size_t i, std::vector<Neighbor>& around) const {
    if (!(reach_[i] > kThin * median_reach_)) return false;
    nearest_on_surface(points_[i], kRegion, around);
    if (around.size() < kRegion) return false;
    std::array<double, kRegion> reaches = {};
    for (std::size_t k = 0; k < kRegion; ++k) reaches[k] = reach_[around[k].index];
    std::nth_element(reaches.begin(), reaches.begin() + kRing, reaches.end());
    if (!(reach_[i] > kThin * reaches[kRing])) return false;
    around.resize(kNeighbourhood);
    const Eigen::Vector3d variances = fit_plane(points_, around).variances;
    return variances[0] > kFlat * variances.sum() && std::sqrt(variances[0]) > rfs_mesh::kStray * sigma_;
  }

  const rfs_mesh::SpatialIndex& index_;
  const Positions& points_;
  const Context& context_;
  std::vector<char> outlier_, look_;
  std::vector<double> reach_;  ///< to the 8th neighbour
  std::vector<double> usual_;  ///< the lower quartile of the neighbours' reaches
  std::vector<char> isolated_;
  rfs_mesh::NeighborTable near_;
  double sigma_;
  double median_reach_ = 0;
};

/// The first kRing of every row, or of rows of their own where these are shorter.
rfs_mesh::NeighborTable nearest_few(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near,
                                    const Context& context) {
  if (near.k < int(kRing)) return index.nearest(int(kRing), context);
  rfs_mesh::NeighborTable few;
  few.k = int(kRing);
  few.items.resize(near.size() * kRing);
  for_each_index(context, near.size(), [&](std::size_t i) {
    std::copy_n(near[i].begin(), kRing, few.items.begin() + std::ptrdiff_t(i * kRing));
  });
  return few;
}

}  // namespace

void find_noise(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near, Statistics& whole,
                const Context& context) {
  if (whole.noise) return;
  const Positions& points = index.points();
  std::vector<char> outlying;
  if (points.size() >= kRegion)
    outlying = Search(index, nearest_few(index, near, context), 0, whole.reach, context).run();
  if (std::find(outlying.begin(), outlying.end(), 1) == outlying.end()) {
    rfs_mesh::known_noise(index, whole, context);
    return;
  }
  Positions left;
  for (std::size_t i = 0; i < outlying.size(); ++i)
    if (outlying[i] == 0) left.push_back(points[i]);
  rfs_mesh::known_noise(rfs_mesh::SpatialIndex(left, context), whole, context);
}

std::vector<char> find_outliers(const rfs_mesh::SpatialIndex& index, const rfs_mesh::NeighborTable& near,
                                Statistics& whole, const Context& context) {
  if (index.points().size() < kRegion) return std::vector<char>(index.points().size(), 0);
  find_noise(index, near, whole, context);
  return Search(index, nearest_few(index, near, context), whole.noise->sigma, whole.reach, context).run();
}

std::vector<char> find_outliers(const Positions& points, const Context& context) {
  if (points.size() < kRegion) return std::vector<char>(points.size(), 0);
  const rfs_mesh::SpatialIndex index(points, context);
  Statistics whole;
  return find_outliers(index, index.nearest(int(kRing), context), whole, context);
}

bool land(const rfs_mesh::SpatialIndex& surface, double most, Eigen::Vector3d& point) {
  std::vector<Neighbor> around;
  surface.nearest(point, 1, around);
  if (around.empty()) return false;
  surface.nearest(surface.points()[around.front().index], int(2 * kRing), around);
  if (around.size() < 2 * kRing) return false;
  const Plane plane = fit_plane(surface.points(), around);
  const double off = plane.normal.dot(point - plane.centre);
  if (!(std::abs(off) <= most)) return false;
  const Eigen::Vector3d landed = point - off * plane.normal;
  const double squared_radius = around.back().squared_distance;
  surface.nearest(landed, 1, around);
  if (!(around.front().squared_distance <= squared_radius)) return false;  // the plane goes on beyond a rim
  point = landed;
  return true;
}

}  // namespace rfsmooth::pipeline
