#include "tests/bench/scans/scan_runs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <tuple>

#include "base/parallel.h"
#include "pipeline/io/io.h"
#include "rfs_mesh/search/neighbors.h"
#include "tests/bench/support/median.h"

namespace rfsmooth::bench {
namespace {

namespace io = pipeline::io;
using Eigen::Vector3d;

/// The finite rows of a file around their first, each place once.
Positions distinct_points(const std::vector<double>& xyz) {
  Positions points;
  Vector3d origin = Vector3d::Zero();
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

/// Degrees between the plane through a point's 12 nearest and the true one.
double normal_error(const rfs_mesh::SpatialIndex& index, const Vector3d& p, const Vector3d& normal) {
  constexpr int kNear = 12;
  constexpr double kDegrees = 57.29577951308232;
  std::vector<rfs_mesh::Neighbor> near;
  index.nearest(p, kNear + 1, near);
  std::vector<Index> rows;
  for (const auto& n : near) rows.push_back(n.index);
  const double cosine = std::abs(fit_plane(index.points(), rows).normal.dot(normal));
  return kDegrees * std::acos(std::min(1.0, cosine));
}

/// Where each row of the scan went; kNone: nowhere.
std::vector<Index> places_of(const Scan& scan, const Cleaned& cleaned) {
  std::vector<Index> place(scan.points.size(), kNone);
  for (Index i = 0; i < cleaned.points.size(); ++i)
    if (cleaned.points[i].allFinite()) place[cleaned.source.empty() ? i : cleaned.source[i]] = i;
  return place;
}

/// Collects one figure of every place.
struct GeometricMean {
  double logs = 0;
  std::size_t count = 0;
  void add(double x) {
    logs += std::log(std::max(x, kLeastRough));
    ++count;
  }
  double value() const { return count == 0 ? 0 : std::exp(logs / double(count)); }
};

/// The rms of `distance(point)` over the rows that are still there.
template <class Distance>
double rms(const std::vector<Index>& rows, const std::vector<Index>& place, const Positions& points,
           Distance&& distance) {
  double squares = 0, count = 0;
  for (const Index row : rows) {
    if (place[row] == kNone) continue;
    squares += std::pow(distance(points[place[row]]), 2);
    ++count;
  }
  return count == 0 ? 0 : std::sqrt(squares / count);
}

/// The mean error of normals at every fourth row.
double mean_angle(const rfs_mesh::SpatialIndex& index, const Patch& patch, const std::vector<Index>& place,
                  const Positions& points) {
  double sum = 0, count = 0;
  for (std::size_t r = 0; r < patch.rows.size(); r += 4) {
    const Index at = place[patch.rows[r]];
    if (at == kNone) continue;
    sum += normal_error(index, points[at], patch.plane.normal);
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

}  // namespace

Scan read_scan(const std::filesystem::path& file, std::size_t most) {
  const auto cloud = value_or_throw(io::read_cloud(file, {}, {}));
  Scan scan;
  scan.name = file.stem().string();
  scan.points = distinct_points(io::positions(cloud));
  crop(most, scan.points);
  if (scan.points.size() > 1) scan.spacing = median_spacing(scan.points);
  return scan;
}

FlatError measure_flats(const Flats& flats, const Scan& scan, const Cleaned& cleaned, int threads) {
  const std::vector<Index> place = places_of(scan, cleaned);
  const Positions& points = cleaned.points;
  GeometricMean plane, angle, crease;
  for (const Patch& patch : flats.patches)
    plane.add(rms(patch.rows, place, points, [&](const Vector3d& p) { return patch.plane.height(p); }) /
              patch.spacing);
  for (const Crease& c : flats.creases)
    crease.add(rms(c.rows, place, points, [&](const Vector3d& p) { return c.distance(p); }) / c.spacing);
  Context context;
  context.threads = threads;
  Positions finite;
  for (const Vector3d& p : points)
    if (p.allFinite()) finite.push_back(p);
  std::vector<double> degrees(flats.patches.size());
  in_arena(context, [&] {
    const rfs_mesh::SpatialIndex index(finite, context);
    for_each_index(context, degrees.size(),
                   [&](std::size_t k) { degrees[k] = mean_angle(index, flats.patches[k], place, points); });
  });
  for (const double d : degrees) angle.add(d);
  return {plane.value(), angle.value(), crease.value()};
}

Cleaned run_peer(const Scan& scan, const std::string& setting, const std::filesystem::path& cache,
                 int threads) {
  const Store store(cache / "peers");
  const auto input = hash_points(scan.points);
  auto result = store.cloud(input, setting);
  for (const auto& peer : peer_settings()) {
    if (result || peer.name != setting) continue;
    result = peer.run(scan.points, threads);
    store.save(input, setting, *result, {});
  }
  if (!result) throw std::invalid_argument("no peer is called \"" + setting + "\"");
  return {std::move(result->points), std::move(result->source)};
}

}  // namespace rfsmooth::bench
