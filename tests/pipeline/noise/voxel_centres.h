/// Clouds of the centres of voxels, turned as a registered scan may be.
#pragma once

#include <array>
#include <set>

#include <Eigen/Geometry>

#include <rfsmooth/mesh.h>

namespace rfsmooth::noisy {

using Voxels = std::set<std::array<int, 3>>;

inline constexpr double kVoxel = 0.06;

inline Positions centres(const Voxels& voxels) {
  const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -0.5).normalized()).matrix();
  Positions points;
  for (const auto& [i, j, k] : voxels)
    points.push_back(kVoxel * (turned * (Eigen::Vector3d(i, j, k).array() + 0.5).matrix()));
  return points;
}

}  // namespace rfsmooth::noisy
