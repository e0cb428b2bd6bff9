/// The points of a cloud that are called outliers, and clouds to look for them in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "clouds/shapes/sampling.h"
#include "pipeline/outliers.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::outliers {

/// Flags by row, whatever the order of the rows: as `denoise` calls it.
inline std::vector<char> find(const Positions& points, int threads = 0) {
  Context context;
  context.threads = threads;
  const auto cloud = rfs_mesh::make_working_cloud(points.data()->data(), points.size(), context).value();
  const std::vector<char> found = pipeline::find_outliers(cloud.points, context);
  std::vector<char> by_row(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) by_row[i] = found[cloud.of_input[i]];
  return by_row;
}

inline std::size_t count(const std::vector<char>& flags) {
  return std::size_t(std::count(flags.begin(), flags.end(), 1));
}

inline Positions noisy(Positions points, double spacings) {
  clouds::add_noise(points, spacings * clouds::mean_spacing(points), 7);
  return points;
}

inline Positions grid(int columns, int rows, double step) {
  Positions points;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) points.emplace_back(step * i, j, 0);
  return points;
}

}  // namespace rfsmooth::outliers
