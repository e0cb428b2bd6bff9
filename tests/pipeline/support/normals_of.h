/// The normals of a cloud by the public call, and the side they are on.
#pragma once

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include <rfsmooth/mesh.h>
#include <rfsmooth/normals.h>

namespace rfsmooth::test {

using Flat = std::vector<double>;

inline Flat row_major(const Positions& points) {
  Flat xyz;
  for (const auto& p : points) xyz.insert(xyz.end(), p.data(), p.data() + 3);
  return xyz;
}

inline Flat normals_of(const Flat& xyz, const NormalsOptions& options = {}, const Context& context = {}) {
  Flat normals(xyz.size(), 7);
  const auto report = estimate_normals(xyz.data(), xyz.size() / 3, options, context, normals.data());
  EXPECT_TRUE(report.ok()) << report.error().message;
  return normals;
}

inline Positions normals_of(const Positions& points, const NormalsOptions& options = {}) {
  const Flat normals = normals_of(row_major(points), options);
  Positions rows;
  for (std::size_t i = 0; i < normals.size(); i += 3)
    rows.emplace_back(normals[i], normals[i + 1], normals[i + 2]);
  return rows;
}

/// The share of the points whose normal is within 90 degrees of `truth`.
template <class Truth>
double share_on_side(const Positions& points, const Positions& normals, Truth&& truth) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) right += normals[i].dot(truth(points[i])) > 0 ? 1 : 0;
  return double(right) / double(points.size());
}

}  // namespace rfsmooth::test
