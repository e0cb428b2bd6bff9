#include "rfs_mesh/noise/steps/scanner_places.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include <Eigen/LU>

#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/sample.h"

namespace rfsmooth::rfs_mesh {

namespace {

constexpr int kRefinements = 5;  // of least squares; ten find the same

/// Two neighbours, and so the plane of the points that are as far from both.
struct Halfway {
  Eigen::Vector3d middle, across;  ///< `across` from one to the other

  /// The difference of the distances from both to `at`, to first order.
  double differs(const Eigen::Vector3d& at) const {
    const Eigen::Vector3d to = middle - at;
    return std::abs(across.dot(to)) / to.norm();
  }
};

/// Of about so many points each with one of its neighbours: the nearest, the next and so on in turn.
std::vector<Halfway> halfway(const SpatialIndex& index, std::size_t count) {
  std::vector<Halfway> pairs;
  std::vector<Neighbor> near;
  std::size_t which = 0;
  for (const Eigen::Vector3d& p : sample(index.points(), count)) {
    index.nearest(p, int(kRing + 1), near);  // and the point itself
    if (near.size() < 2) break;
    const Eigen::Vector3d q = index.points()[near[1 + which++ % (near.size() - 1)].index];
    if (q != p) pairs.push_back({(p + q) / 2, q - p});
  }
  return pairs;
}

/// Moves those that are as far from `at` to the front. Returns the end of these.
std::vector<Halfway>::iterator part(std::vector<Halfway>& pairs, const Eigen::Vector3d& at, double same) {
  return std::partition(pairs.begin(), pairs.end(),
                        [&](const Halfway& pair) { return pair.differs(at) <= same; });
}

/// Where three planes meet; not finite if they do not.
Eigen::Vector3d meeting(const Halfway& a, const Halfway& b, const Halfway& c) {
  Eigen::Matrix3d normals;
  normals << a.across.transpose(), b.across.transpose(), c.across.transpose();
  return normals.inverse() *
         Eigen::Vector3d(a.across.dot(a.middle), b.across.dot(b.middle), c.across.dot(c.middle));
}

/// Of the places where three of the planes meet, the one that most of them pass within `same` of. \param
/// fewest so many must.
std::optional<Eigen::Vector3d> rough_place(const std::vector<Halfway>& pairs, double same, double fewest) {
  constexpr double kMissed = 7;  // trials for each that is expected to hit: one search in e^7 finds nothing
  std::mt19937 engine(1);
  const auto any = [&]() -> const Halfway& { return pairs[engine() % pairs.size()]; };
  std::optional<Eigen::Vector3d> best;
  double most = fewest;
  // A fourth must agree before all are asked.
  for (double trial = 0; trial * std::pow(most / double(pairs.size()), 4) < kMissed; ++trial) {
    const Halfway &a = any(), &b = any(), &c = any();
    const Eigen::Vector3d at = meeting(a, b, c);
    if (!(any().differs(at) <= same)) continue;
    const auto count = double(std::count_if(pairs.begin(), pairs.end(),
                                            [&](const Halfway& pair) { return pair.differs(at) <= same; }));
    if (count <= most) continue;
    most = count;
    best = at;
  }
  return best;
}

/// The place that all pairs tell together, by least squares over those that are as far from it.
Eigen::Vector3d common_place(std::vector<Halfway>& pairs, Eigen::Vector3d at, double same) {
  for (int round = 0; round < kRefinements; ++round) {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto end = part(pairs, at, same);
    for (auto pair = pairs.begin(); pair != end; ++pair) {
      const Eigen::Vector3d across = pair->across / (pair->middle - at).norm();
      squares += across * across.transpose();
      right += across * across.dot(pair->middle);
    }
    at = squares.inverse() * right;
  }
  return at;
}

/// The place to more digits: from points that are far apart on one shell. \param points on shells. \param
/// within how far the ranges of points that follow each other on a shell are apart, world units.
Eigen::Vector3d refined_place(const Positions& points, Eigen::Vector3d at, double within) {
  std::vector<std::pair<double, Eigen::Vector3d>> seen;  // range and ray
  for (int round = 0; round < kRefinements; ++round) {
    seen.clear();
    for (const Eigen::Vector3d& p : points) seen.emplace_back((p - at).norm(), (p - at).normalized());
    std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t begin = 0, end = 0; begin < seen.size(); begin = end) {
      auto [range, ray] = seen[end++];
      for (; end < seen.size() && seen[end].first - seen[end - 1].first <= within; ++end) {
        range += seen[end].first;
        ray += seen[end].second;
      }
      for (std::size_t i = begin; i < end; ++i) {
        const Eigen::Vector3d turns = seen[i].second - ray / double(end - begin);
        squares += turns * turns.transpose();
        right += turns * (seen[i].first - range / double(end - begin));
      }
    }
    at += squares.inverse() * right;
  }
  return at;
}

/// A place that was found among few pairs, from all of them.
Eigen::Vector3d measured_place(std::vector<Halfway> pairs, const Eigen::Vector3d& rough, double same) {
  Eigen::Vector3d at = common_place(pairs, rough, same);
  if (!at.allFinite()) return at;
  const auto others = part(pairs, at, same);
  Positions points;
  for (auto pair = pairs.begin(); pair != others; ++pair)
    for (const double end : {-0.5, 0.5}) points.push_back(pair->middle + end * pair->across);
  std::vector<double> differences;
  for (auto pair = others; pair != pairs.end(); ++pair) differences.push_back(pair->differs(at));
  const double step = differences.empty() ? 0 : quantile(differences, kLeastPart);
  return refined_place(points, at, std::max(same, step / 4));
}

}  // namespace

Positions scanner_places(const SpatialIndex& index, double same) {
  std::vector<Halfway> pairs = halfway(index, kPlacesOfCloud), all;
  const double fewest = kLeastPart * double(pairs.size());
  Positions places;
  while (double(pairs.size()) > fewest) {
    const auto rough = rough_place(pairs, same, fewest);
    if (!rough) break;
    if (all.empty()) all = halfway(index, kSampleOfCloud);
    const Eigen::Vector3d at = measured_place(all, *rough, same);
    const auto others = part(pairs, at, same);
    if (!(double(others - pairs.begin()) > fewest)) break;  // no one place: any on the axis of rings would do
    places.push_back(at);
    pairs.erase(pairs.begin(), others);
  }
  return places;
}

}  // namespace rfsmooth::rfs_mesh
