/// Clouds whose coordinates were rounded.
#pragma once

#include <Eigen/Core>

#include <rfsmooth/mesh.h>

namespace rfsmooth::test {

/// To multiples of `unit`.
inline Positions to_decimals(Positions points, double unit) {
  for (Eigen::Vector3d& p : points) p = unit * (p / unit).array().round().matrix();
  return points;
}

}  // namespace rfsmooth::test
