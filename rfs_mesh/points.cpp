#include "rfs_mesh/points.h"

#include <cmath>

#include <fmt/format.h>

#include "base/morton.h"
#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

struct Box {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  std::size_t finite = 0;
  void add(const Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    ++finite;
  }
  static Box join(Box a, const Box& b) {
    a.low = a.low.cwiseMin(b.low);
    a.high = a.high.cwiseMax(b.high);
    a.finite += b.finite;
    return a;
  }
};

struct Keyed {
  std::uint64_t code;
  Index input;
};

}  // namespace

std::size_t WorkingCloud::finite() const {
  std::size_t n = 0;
  for (const Index m : multiplicity) n += m;
  return n;
}

namespace {

WorkingCloud make(const double* xyz, std::size_t n, const Context& context) {
  if (n >= kNone)
    throw Failure({ErrorCode::usage, fmt::format("{} points; at most {} are supported", n, kNone - 1)});
  const auto point = [xyz](std::size_t i) { return Vector3d(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]); };

  const Box box = reduce_blocks(
      context, n, Box{},
      [&](std::size_t b, std::size_t e) {
        Box part;
        for (std::size_t i = b; i < e; ++i)
          if (const Vector3d p = point(i); p.allFinite()) part.add(p);
        return part;
      },
      Box::join);
  if (box.finite == 0)
    throw Failure({ErrorCode::no_usable_points,
                   n == 0 ? "the cloud has no points" : fmt::format("none of the {} points is finite", n)});

  WorkingCloud cloud;
  cloud.origin = 0.5 * box.low + 0.5 * box.high;
  const double extent = (0.5 * box.high - 0.5 * box.low).maxCoeff() * 2;
  constexpr double kLargest = 1e100, kSmallest = 1e-100;
  if (extent > kLargest || (extent > 0 && extent < kSmallest))
    throw Failure({ErrorCode::no_usable_points,
                   fmt::format("the points extend over {:g}; rescale the cloud to between {:g} and {:g}",
                               extent, kSmallest, kLargest)});

  // Morton code on a 2^21 grid over the box; points in one cell are ordered by their coordinates.
  const double to_cell = extent > 0 ? kMortonCells / extent : 0;
  std::vector<Keyed> keyed(n);
  for_each_index(context, n, [&](std::size_t i) {
    const Vector3d p = point(i);
    if (!p.allFinite()) {
      keyed[i] = {std::numeric_limits<std::uint64_t>::max(), Index(i)};
      return;
    }
    keyed[i] = {morton_code(p, box.low, to_cell), Index(i)};
  });
  const auto lexicographic = [&](const Vector3d& p, const Vector3d& q) {
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != q[axis]) return p[axis] < q[axis] ? -1 : 1;
    return 0;
  };
  parallel_sort(context, keyed, [&](const Keyed& a, const Keyed& b) {
    if (a.code != b.code) return a.code < b.code;
    if (a.code != std::numeric_limits<std::uint64_t>::max())
      if (const int order = lexicographic(point(a.input), point(b.input)); order != 0) return order < 0;
    return a.input < b.input;
  });

  cloud.of_input.assign(n, kNone);
  cloud.points.reserve(box.finite);
  cloud.multiplicity.reserve(box.finite);
  for (std::size_t s = 0; s < box.finite; ++s) {
    const Vector3d p = point(keyed[s].input);
    if (s == 0 || lexicographic(point(keyed[s - 1].input), p) != 0) {
      cloud.points.push_back(p - cloud.origin);
      cloud.multiplicity.push_back(0);
    }
    ++cloud.multiplicity.back();
    cloud.of_input[keyed[s].input] = Index(cloud.points.size() - 1);
  }
  return cloud;
}

}  // namespace

Result<WorkingCloud> make_working_cloud(const double* xyz, std::size_t n, const Context& context) {
  return guarded([&] { return make(xyz, n, context); });
}

}  // namespace rfsmooth::rfs_mesh
