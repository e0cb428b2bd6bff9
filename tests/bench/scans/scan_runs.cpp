#include "tests/bench/scans/scan_runs.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <Eigen/Geometry>

#include "pipeline/io/io.h"
#include "rfs_mesh/search/neighbors.h"
#include "tests/bench/quality/runs.h"
#include "tests/bench/support/median.h"

namespace rfsmooth::bench {
namespace {

namespace io = pipeline::io;
using Eigen::Vector3d;

/// The finite rows of a file around their first, each place once. Sets that origin.
Positions distinct_points(const std::vector<double>& xyz, Vector3d& origin) {
  Positions points;
  origin.setZero();
  std::set<std::tuple<double, double, double>> seen;
  for (std::size_t i = 0; i + 2 < xyz.size(); i += 3) {
    const Vector3d p(xyz[i], xyz[i + 1], xyz[i + 2]);
    if (!p.allFinite()) continue;
    if (points.empty()) origin = p;
    if (seen.emplace(p[0], p[1], p[2]).second) points.push_back(p - origin);
  }
  return points;
}

Vector3d median_point(const Positions& points) {
  Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Vector3d& p : points) values.push_back(p[axis]);
    middle[axis] = median(values);
  }
  return middle;
}

void crop(std::size_t most, Positions& points) {
  if (points.size() <= most) return;
  const Vector3d middle = median_point(points);
  std::vector<std::pair<double, Index>> order;
  for (Index i = 0; i < points.size(); ++i) order.emplace_back((points[i] - middle).squaredNorm(), i);
  std::sort(order.begin(), order.end());
  order.resize(most);
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  Positions kept;
  for (const auto& [d, i] : order) kept.push_back(points[i]);
  points = std::move(kept);
}

double median_spacing(const Positions& points) {
  const rfs_mesh::SpatialIndex index(points, {});
  const auto near = index.nearest(1, {});
  std::vector<double> gaps;
  for (std::size_t i = 0; i < points.size(); ++i)
    gaps.push_back((points[i] - points[*near[i].begin()]).norm());
  return median(gaps);
}

}  // namespace

Scan read_scan(const std::filesystem::path& file, std::size_t most) {
  const auto cloud = value_or_throw(io::read_cloud(file, {}, {}));
  Scan scan;
  scan.name = file.stem().string();
  scan.points = distinct_points(io::positions(cloud), scan.origin);
  crop(most, scan.points);
  if (scan.points.size() > 1) scan.spacing = median_spacing(scan.points);
  return scan;
}

void turn(Scan& scan) {
  const Eigen::Matrix3d by = Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  Vector3d farthest = Vector3d::Zero();
  for (Vector3d& p : scan.points) {
    p = by * p;
    farthest = farthest.cwiseMax(p.cwiseAbs());
  }
  scan.origin = 3 * farthest;
}

OurResult run_ours(const Scan& scan, const Variant& variant, int threads) {
  Positions points = scan.points;
  for (Vector3d& p : points) p += scan.origin;
  OurResult ours = run_ours(points, variant, threads);
  for (Vector3d& p : ours.points) p -= scan.origin;
  return ours;
}

Cleaned run_peer(const Scan& scan, const std::string& setting, const std::filesystem::path& cache,
                 int threads) {
  auto result = peer_result(cache, scan.points, setting, threads);
  return {std::move(result.points), std::move(result.source)};
}

}  // namespace rfsmooth::bench
