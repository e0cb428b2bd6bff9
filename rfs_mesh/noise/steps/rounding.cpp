#include "rfs_mesh/noise/steps/rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace rfsmooth::rfs_mesh {

namespace {

constexpr double kSevenDigits = 2e-6;  // of a distance, with what single precision adds in a sum of squares

}  // namespace

double seven_digits(const Positions& points, const Eigen::Vector3d& from) {
  double farthest = 0;
  for (const Eigen::Vector3d& p : points) farthest = std::max(farthest, (p - from).norm());
  return kSevenDigits * farthest;
}

double rounding_of(const Positions& points) {
  const double digits = seven_digits(points, points.front());
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : points) values.push_back(p[axis]);
    std::sort(values.begin(), values.end());
    for (std::size_t i = 1; i < values.size(); ++i)
      if (const double gap = values[i] - values[i - 1]; gap > digits) least = std::min(least, gap);
  }
  return std::isfinite(least) ? least : digits;
}

}  // namespace rfsmooth::rfs_mesh
