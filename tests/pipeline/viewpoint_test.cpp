#include "pipeline/viewpoint.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pipeline/io/io.h"

namespace rfsmooth::pipeline {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kWidth = 40, kHeight = 30;

/// What a camera at the origin that looks along z sees of a bumpy wall; a few pixels saw nothing.
std::vector<double> range_image(const Vector3d& moved = Vector3d::Zero()) {
  std::vector<double> xyz;
  for (std::size_t row = 0; row < kHeight; ++row)
    for (std::size_t column = 0; column < kWidth; ++column) {
      const double u = (double(column) - 20) / 40, v = (double(row) - 15) / 40;
      const double depth =
          (row + column) % 17 == 0 ? std::nan("") : 2 + 0.1 * std::sin(9 * u) * std::cos(7 * v);
      for (const double c : {u * depth, v * depth, depth}) xyz.push_back(c);
      for (std::size_t axis = 0; axis < 3; ++axis) xyz[xyz.size() - 3 + axis] += moved[Eigen::Index(axis)];
    }
  return xyz;
}

io::Cloud organised(const std::vector<double>& xyz) {
  io::Cloud cloud = io::make_cloud(xyz.data(), xyz.size() / 3);
  cloud.width = kWidth;
  cloud.height = kHeight;
  return cloud;
}

TEST(Viewpoint, ARangeImageWasSeenFromItsCameraAndNotFromElsewhere) {
  const auto image = range_image();
  EXPECT_TRUE(seen_from({0, 0, 0}, image.data(), kWidth, kHeight, {}));
  EXPECT_FALSE(seen_from({0, 0, 2}, image.data(), kWidth, kHeight, {})) << "a place on the wall";
  EXPECT_FALSE(seen_from({0, 0, 0}, image.data(), image.size() / 3, 1, {})) << "no grid, no triangles";
  EXPECT_FALSE(seen_from({0, 0, 0}, nullptr, 0, 0, {}));
}

TEST(Viewpoint, TheDefaultOfAPcdIsBelievedOnlyWhereTheGridFits) {
  const auto image = range_image(), moved = range_image({0, 0, -2});
  io::Cloud cloud = organised(image);
  ASSERT_TRUE(recorded_viewpoint(cloud, image.data(), {}).has_value());
  EXPECT_EQ(*recorded_viewpoint(cloud, image.data(), {}), Vector3d(0, 0, 0));
  EXPECT_FALSE(recorded_viewpoint(organised(moved), moved.data(), {}).has_value());
  cloud.width = image.size() / 3;
  cloud.height = 1;
  EXPECT_FALSE(recorded_viewpoint(cloud, image.data(), {}).has_value()) << "unorganised";
}

TEST(Viewpoint, AnythingElseIsBelieved) {
  const auto image = range_image();
  io::Cloud cloud = io::make_cloud(image.data(), image.size() / 3);
  cloud.viewpoint = "1 -2.5 3e1 1 0 0 0";
  EXPECT_EQ(recorded_viewpoint(cloud, image.data(), {}).value(), Vector3d(1, -2.5, 30));
  cloud.viewpoint = "0 0 0 0 1 0 0";
  EXPECT_EQ(recorded_viewpoint(cloud, image.data(), {}).value(), Vector3d(0, 0, 0));
  cloud.viewpoint = "0.0 0 0 1.0 0 0 0";
  EXPECT_FALSE(recorded_viewpoint(cloud, image.data(), {}).has_value()) << "the default in other words";
  cloud.viewpoint = "nan 0 0 1 0 0 0";
  EXPECT_FALSE(recorded_viewpoint(cloud, image.data(), {}).has_value());
}

}  // namespace
}  // namespace rfsmooth::pipeline
