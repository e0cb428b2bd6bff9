#include "pipeline/tiles/steps/measure.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace rfsmooth::pipeline::tiles {

void keep_middle(const Job& job, std::size_t tile, std::uint64_t wanted, std::vector<Record>& points) {
  using Eigen::Vector3d;
  const double share = double(wanted) / double(job.in_tiles());
  const auto kept = std::size_t(std::ceil(share * double(job.tiles[tile].points)));
  if (kept >= points.size() || points.empty()) return;
  const Vector3d middle = 0.5 * (job.tiles[tile].box.low + job.tiles[tile].box.high);
  const auto nearer = [](const Vector3d& to) {
    return [to](const Record& a, const Record& b) {
      const double x = (place(a) - to).squaredNorm(), y = (place(b) - to).squaredNorm();
      return x != y ? x < y : a.row < b.row;
    };
  };
  const Vector3d centre = place(*std::min_element(points.begin(), points.end(), nearer(middle)));
  std::nth_element(points.begin(), points.begin() + std::ptrdiff_t(kept), points.end(), nearer(centre));
  points.resize(kept);
  std::sort(points.begin(), points.end(), [](const Record& a, const Record& b) { return a.row < b.row; });
}

bool is_measured(const Job& job, std::size_t tile, const Context& context) {
  return complete_records(job.sampled(tile), context).has_value();
}

void measure_tile(const Job& job, std::size_t tile, const Context& context) {
  check_tile(job, tile);
  if (is_measured(job, tile, context)) return;
  std::vector<Record> points = read_records(job.cut(tile), context);
  keep_middle(job, tile, job.measured, points);
  RecordWriter writer(job.sampled(tile), context);
  for (const Record& r : points) writer.add(r);
  writer.commit();
}

}  // namespace rfsmooth::pipeline::tiles
