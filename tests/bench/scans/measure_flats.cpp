#include "tests/bench/scans/measure_flats.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::bench {
namespace {

using Eigen::Vector3d;

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
std::vector<Index> places_of(std::size_t rows, const Cleaned& cleaned) {
  std::vector<Index> place(rows, kNone);
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

FlatError measure_flats(const Flats& flats, std::size_t rows, const Cleaned& cleaned,
                        const Context& context) {
  const std::vector<Index> place = places_of(rows, cleaned);
  const Positions& points = cleaned.points;
  GeometricMean plane, angle, crease;
  for (const Patch& patch : flats.patches)
    plane.add(rms(patch.rows, place, points, [&](const Vector3d& p) { return patch.plane.height(p); }) /
              patch.spacing);
  for (const Crease& c : flats.creases)
    crease.add(rms(c.rows, place, points, [&](const Vector3d& p) { return c.distance(p); }) / c.spacing);
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

}  // namespace rfsmooth::bench
