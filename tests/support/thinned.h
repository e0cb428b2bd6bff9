/// Clouds as tools thin them in voxels.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <rfsmooth/mesh.h>

namespace rfsmooth::support {

/// The mean of the points in each voxel; voxels are cubes with edges along the axes, one of them at 0, 0, 0.
inline Positions means_of_voxels(const Positions& points, double size) {
  std::map<std::array<double, 3>, std::pair<Eigen::Vector3d, double>> voxels;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d at = (p / size).array().floor();
    auto& [sum, count] =
        voxels.try_emplace({at.x(), at.y(), at.z()}, Eigen::Vector3d::Zero(), 0.0).first->second;
    sum += p;
    ++count;
  }
  Positions means;
  for (const auto& [at, all] : voxels) means.push_back(all.first / all.second);
  return means;
}

}  // namespace rfsmooth::support
