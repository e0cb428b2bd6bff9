#include "pipeline/prepare.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "pipeline/outliers.h"
#include "pipeline/twins.h"
#include "pipeline/units/units.h"
#include "rfs_mesh/connect/connect.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::pipeline {

namespace {

/// Takes the outliers out of the working cloud. `outlier`: one flag for each of its points. \return one for
/// each row.
std::vector<char> set_aside(const std::vector<char>& outlier, rfs_mesh::WorkingCloud& cloud) {
  std::vector<Index> renumbered(outlier.size(), kNone);
  Index next = 0;
  for (std::size_t p = 0; p < outlier.size(); ++p) {
    if (outlier[p] != 0) continue;
    renumbered[p] = next;
    cloud.points[next] = cloud.points[p];
    ++next;
  }
  cloud.points.resize(next);
  std::vector<char> rows(cloud.of_input.size(), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Index& p = cloud.of_input[i];
    if (p == kNone) continue;
    rows[i] = outlier[p];
    p = renumbered[p];
  }
  return rows;
}

}  // namespace

Prepared prepare(rfs_mesh::WorkingCloud& cloud, int neighbours, Outliers outliers, Statistics& whole,
                 std::vector<StageTime>& seconds, const Context& context) {
  whole.box = cloud.box;
  Prepared prepared;
  auto& [index, near, outlier] = prepared;
  Stopwatch watch(seconds, "index");
  context.report("index", 0);
  index.emplace(cloud.points, context);
  watch.next("neighbours");
  context.report("neighbours", 0);
  near = index->nearest(neighbours, context);
  if (join_twins(near, cloud, context)) {
    index.emplace(cloud.points, context);
    near = index->nearest(neighbours, context);
  }
  if (outliers == Outliers::smooth) return prepared;
  watch.next("noise");
  context.report("noise", 0);
  find_noise(*index, near, whole, context);
  watch.next("outliers");
  const std::vector<char> found = find_outliers(*index, near, whole, context);
  if (std::find(found.begin(), found.end(), 1) != found.end()) {
    outlier = set_aside(found, cloud);
    index.emplace(cloud.points, context);
    near = rfs_mesh::nearest_left(near, found, *index, context);
  }
  return prepared;
}

Measured measure_points(std::vector<double> xyz, Outliers outliers, Statistics known,
                        const Context& context) {
  Measured measured;
  Statistics& whole = measured.statistics;
  whole = std::move(known);
  in_arena(context, [&] {
    const std::size_t n = xyz.size() / 3;
    const double unit = working_unit(xyz.data(), n, context);
    for (double& x : xyz) x *= unit;
    change_units(whole, unit);
    auto cloud = value_or_throw(
        rfs_mesh::make_working_cloud(xyz.data(), n, context, whole.box ? &*whole.box : nullptr));
    std::vector<double>().swap(xyz);
    measured.finite = cloud.finite();
    measured.distinct = cloud.points.size();
    std::vector<StageTime> seconds;  // nobody asks
    Prepared prepared = prepare(cloud, int(rfs_mesh::kRing), outliers, whole, seconds, context);
    rfs_mesh::measure_cloud(*prepared.index, prepared.near, whole, context);
    measured.outlier = std::move(prepared.outlier);
    measured.points = std::move(cloud.points);
    for (Eigen::Vector3d& p : measured.points) p /= unit;
    change_units(whole, 1 / unit);
  });
  return measured;
}

}  // namespace rfsmooth::pipeline
