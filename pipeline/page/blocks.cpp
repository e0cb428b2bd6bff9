#include "pipeline/page/blocks.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline {

using Eigen::Vector3d;

namespace {

constexpr double kSteps = 65535, kUnits = 127;

/// Writes planes of `n` bytes.
class Planes {
 public:
  Planes(std::size_t n, std::size_t planes) : n_(n), bytes_(n * planes, '\0') {}
  /// Takes the next planes for its own. \return the first.
  std::size_t take(std::size_t planes) {
    const std::size_t first = taken_;
    taken_ += planes;
    return first;
  }
  void put(std::size_t plane, std::size_t point, unsigned byte) {
    bytes_[plane * n_ + point] = char(static_cast<unsigned char>(byte & 255));
  }
  std::string release() { return std::move(bytes_); }

 private:
  std::size_t n_, taken_ = 0;
  std::string bytes_;
};

/// Blocks of points [begin, end), origins and steps.
std::vector<PageBlock> cut(const ShownPoints& shown) {
  std::vector<PageBlock> blocks;
  for (std::size_t i = 0; i < shown.before.size(); ++i) {
    if (blocks.empty() || blocks.back().count == kBlockPoints || blocks.back().kind != shown.kinds[i]) {
      blocks.emplace_back();
      blocks.back().kind = shown.kinds[i];
    }
    ++blocks.back().count;
  }
  return blocks;
}

/// Positions of a block's points from `first` on: chooses origin, step and unit, and fills the planes.
void pack_block(const ShownPoints& shown, std::size_t first, PageBlock& block, std::size_t places,
                std::size_t moves, Planes& planes) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = first; i < first + block.count; ++i) box.extend(shown.before[i]);
  const Vector3d& low = box.min();
  block.origin = low;
  block.step = box.sizes().maxCoeff() / kSteps;
  Positions decoded(block.count, low);
  std::array<int, 3> last{};
  for (std::size_t k = 0; k < block.count; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const double offset = shown.before[first + k][axis] - low[axis];
      const int place = block.step > 0 ? int(std::lround(std::min(offset / block.step, kSteps))) : 0;
      decoded[k][axis] += block.step * place;
      const auto difference = std::int16_t(std::uint16_t(place - last[std::size_t(axis)]));
      const auto zigzag = unsigned(difference < 0 ? -2 * difference - 1 : 2 * difference);
      planes.put(places + 2 * std::size_t(axis), first + k, zigzag >> 8);
      planes.put(places + 2 * std::size_t(axis) + 1, first + k, zigzag);
      last[std::size_t(axis)] = place;
    }
  double largest = 0;
  for (std::size_t k = 0; k < block.count; ++k)
    largest = std::max(largest, (shown.after[first + k] - decoded[k]).cwiseAbs().maxCoeff());
  block.unit = largest / kUnits;
  for (std::size_t k = 0; k < block.count && block.unit > 0; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const double move = (shown.after[first + k][axis] - decoded[k][axis]) / block.unit;
      planes.put(moves + std::size_t(axis), first + k, unsigned(int(std::lround(move))));
    }
}

/// The distance from every point to its sixth nearest other one (fewer points: to the farthest); 0 for one
/// alone.
std::vector<double> sixth_distances(const Positions& points, const Context& context) {
  std::vector<double> distances(points.size(), 0);
  const rfs_mesh::SpatialIndex index(points, context);
  const rfs_mesh::NeighborTable nearest = index.nearest(6, context);
  if (nearest.k > 0)
    for_each_index(context, points.size(), [&](std::size_t i) {
      distances[i] = (points[*(nearest[i].end() - 1)] - points[i]).norm();
    });
  return distances;
}

/// The value that three quarters of [first, last) do not exceed: in one half of a block points may be
/// farther apart than in the other, and there should be no holes between them.
double upper_quartile(std::vector<double>::const_iterator first, std::vector<double>::const_iterator last) {
  std::vector<double> values(first, last);
  return quantile(values, 0.75);
}

/// Fills in `reach`: outliers and removed points are drawn as large as the others.
void measure_reach(const Positions& points, std::vector<PageBlock>& blocks, const Context& context) {
  const std::vector<double> distances = sixth_distances(points, context);
  const double usual = upper_quartile(distances.begin(), distances.end());
  auto first = distances.begin();
  for (PageBlock& block : blocks) {
    const auto last = first + std::ptrdiff_t(block.count);
    block.reach = block.kind == RowKind::surface ? upper_quartile(first, last) : usual;
    first = last;
  }
}

void pack_normals(const std::vector<Eigen::Vector3f>& normals, Planes& planes) {
  if (normals.empty()) return;
  const std::size_t plane = planes.take(2);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const auto packed = packed_normal(normals[i]);
    for (std::size_t k = 0; k < 2; ++k) planes.put(plane + k, i, unsigned(int(packed[k])));
  }
}

}  // namespace

std::array<std::int8_t, 2> packed_normal(const Eigen::Vector3f& normal) {
  const float sum = normal.cwiseAbs().sum();
  if (!std::isfinite(sum) || sum == 0) return {0, 0};
  const Eigen::Vector3f n = (normal[2] < 0 ? -normal : normal) / sum;
  const auto in_units = [](float value) { return std::int8_t(std::lround(double(value) * kUnits)); };
  return {in_units(n[0] + n[1]), in_units(n[0] - n[1])};
}

PackedPoints pack_points(const ShownPoints& shown, const Context& context) {
  const std::size_t n = shown.before.size();
  PackedPoints packed;
  packed.blocks = cut(shown);
  Planes planes(n, 9 + (shown.colors.empty() ? 0 : 3) + (shown.normals_before.empty() ? 0 : 2) +
                       (shown.normals_after.empty() ? 0 : 2));
  const std::size_t places = planes.take(6), moves = planes.take(3);
  std::size_t first = 0;
  for (PageBlock& block : packed.blocks) {
    pack_block(shown, first, block, places, moves, planes);
    first += block.count;
  }
  if (!shown.colors.empty()) {
    const std::size_t plane = planes.take(3);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = 0; k < 3; ++k) planes.put(plane + k, i, shown.colors[i][k]);
  }
  pack_normals(shown.normals_before, planes);
  pack_normals(shown.normals_after, planes);
  measure_reach(shown.before, packed.blocks, context);
  packed.bytes = planes.release();
  return packed;
}

}  // namespace rfsmooth::pipeline
