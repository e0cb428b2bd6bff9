#include "rfs_mesh/points.h"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "base/fail.h"
#include "base/morton.h"
#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

using Eigen::Vector3d;

std::size_t WorkingCloud::finite() const {
  std::size_t n = 0;
  for (const Index m : multiplicity) n += m;
  return n;
}

namespace {

/// The cloud as it was given: n x 3 numbers, some of them perhaps not finite.
struct Input {
  const double* xyz;
  std::size_t n;
  Vector3d operator[](std::size_t i) const { return Eigen::Map<const Vector3d>(xyz + 3 * i); }
};

/// The box of the finite points, and how many they are.
struct Extent {
  Eigen::AlignedBox3d box;
  std::size_t finite = 0;
};

Extent extent_of(const Input& input, const Context& context) {
  return reduce_blocks(
      context, input.n, Extent{},
      [&](std::size_t begin, std::size_t end) {
        Extent part;
        for (std::size_t i = begin; i < end; ++i)
          if (const Vector3d p = input[i]; p.allFinite()) {
            part.box.extend(p);
            ++part.finite;
          }
        return part;
      },
      [](const Extent& a, const Extent& b) {
        return Extent{a.box.merged(b.box), a.finite + b.finite};
      });
}

/// The largest side of the box; a failure where its square would not be a number.
double usable_side(const Statistics::Box& box) {
  const double side = largest_side(box);
  if (!is_in_range(side))
    throw Failure({ErrorCode::no_usable_points,
                   fmt::format("the points extend over {:g}; rescale the cloud to between {:g} and {:g}",
                               side, kSmallestSide, kLargestSide)});
  return side;
}

/// -1, 0 or 1: by x, then y, then z.
int compare(const Vector3d& p, const Vector3d& q) {
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] != q[axis]) return p[axis] < q[axis] ? -1 : 1;
  return 0;
}

WorkingCloud make(const Input& input, const Statistics::Box* box, const Context& context) {
  const std::size_t n = input.n;
  if (n >= kNone)
    throw Failure({ErrorCode::usage, fmt::format("{} points; at most {} are supported", n, kNone - 1)});
  Extent extent = extent_of(input, context);
  if (extent.finite == 0) {
    if (n == 0) fail(ErrorCode::no_usable_points, "the cloud has no points");
    if (n == 1) fail(ErrorCode::no_usable_points, "the only point is not finite");
    fail(ErrorCode::no_usable_points, "none of the {} points is finite", n);
  }
  if (box != nullptr) {
    const Eigen::AlignedBox3d whole(box->low, box->high);
    if (!whole.contains(extent.box))
      throw Failure(
          {ErrorCode::usage, "a point is outside the box of the statistics: they are of another cloud"});
    extent.box = whole;
  }
  WorkingCloud cloud;
  cloud.box = {extent.box.min(), extent.box.max()};
  const auto rows = morton_order<Index>(
      n, [&](std::size_t i) { return input[i]; }, extent.box.min(), usable_side(cloud.box),
      [&](Index a, Index b) { return compare(input[a], input[b]); }, context);

  cloud.origin = 0.5 * extent.box.min() + 0.5 * extent.box.max();
  cloud.of_input.assign(n, kNone);
  cloud.points.reserve(extent.finite);
  cloud.multiplicity.reserve(extent.finite);
  for (std::size_t k = 0; k < extent.finite; ++k) {
    const Vector3d p = input[rows[k]];
    if (k == 0 || compare(input[rows[k - 1]], p) != 0) {
      cloud.points.push_back(p - cloud.origin);
      cloud.multiplicity.push_back(0);
    }
    ++cloud.multiplicity.back();
    cloud.of_input[rows[k]] = Index(cloud.points.size() - 1);
  }
  return cloud;
}

}  // namespace

std::optional<Statistics::Box> finite_box(const double* xyz, std::size_t n, const Context& context) {
  const Extent extent = extent_of({xyz, n}, context);
  if (extent.finite == 0) return {};
  return Statistics::Box{extent.box.min(), extent.box.max()};
}

double largest_side(const Statistics::Box& box) {
  return (0.5 * box.high - 0.5 * box.low).maxCoeff() * 2;
}

bool is_in_range(double side) {
  return side == 0 || (side >= kSmallestSide && side <= kLargestSide);
}

Result<WorkingCloud> make_working_cloud(const double* xyz, std::size_t n, const Context& context,
                                        const Statistics::Box* box) {
  return guarded([&] { return make({xyz, n}, box, context); });
}

}  // namespace rfsmooth::rfs_mesh
