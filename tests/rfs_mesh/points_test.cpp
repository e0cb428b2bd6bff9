#include "rfs_mesh/points.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

using rfsmooth::ErrorCode;
using rfsmooth::kNone;
using rfsmooth::rfs_mesh::make_working_cloud;

namespace {

std::vector<double> random_xyz(std::size_t n, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<double> xyz(3 * n);
  for (double& v : xyz) v = coordinate(engine);
  return xyz;
}

TEST(WorkingCloud, EveryFiniteRowIsItsPointPlusTheOrigin) {
  std::vector<double> xyz = random_xyz(5000, 1);
  for (double& v : xyz) v += 4649776;
  const auto cloud = make_working_cloud(xyz.data(), 5000, {}).value();
  for (std::size_t i = 0; i < 5000; ++i)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(cloud.points[cloud.of_input[i]][axis] + cloud.origin[axis], xyz[3 * i + axis]);
}

TEST(WorkingCloud, NonFiniteRowsAreLeftOut) {
  std::vector<double> xyz = random_xyz(10, 2);
  xyz[3 * 4 + 1] = NAN;
  xyz[3 * 7] = -INFINITY;
  const auto cloud = make_working_cloud(xyz.data(), 10, {}).value();
  EXPECT_EQ(cloud.points.size(), 8u);
  EXPECT_EQ(cloud.of_input[4], kNone);
  EXPECT_EQ(cloud.of_input[7], kNone);
  EXPECT_EQ(cloud.finite(), 8u);
}

TEST(WorkingCloud, DuplicatesShareOnePoint) {
  std::vector<double> xyz = random_xyz(100, 3);
  const std::vector<double> once = xyz;
  xyz.insert(xyz.end(), once.begin(), once.end());
  const auto cloud = make_working_cloud(xyz.data(), 200, {}).value();
  EXPECT_EQ(cloud.points.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(cloud.of_input[i], cloud.of_input[i + 100]);
  ASSERT_EQ(cloud.multiplicity.size(), 100u);
  for (const auto m : cloud.multiplicity) EXPECT_EQ(m, 2u);
}

TEST(WorkingCloud, OrderOfInputDoesNotMatter) {
  const std::size_t n = 20000;
  const std::vector<double> xyz = random_xyz(n, 4);
  std::vector<std::size_t> order(n);
  for (std::size_t i = 0; i < n; ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937_64(5));
  std::vector<double> shuffled(3 * n);
  for (std::size_t i = 0; i < n; ++i)
    for (int axis = 0; axis < 3; ++axis) shuffled[3 * i + axis] = xyz[3 * order[i] + axis];
  const auto a = make_working_cloud(xyz.data(), n, {}).value();
  const auto b = make_working_cloud(shuffled.data(), n, {}).value();
  EXPECT_EQ(a.points, b.points);
  for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(b.of_input[i], a.of_input[order[i]]);
}

TEST(WorkingCloud, NothingUsableIsAnError) {
  EXPECT_EQ(make_working_cloud(nullptr, 0, {}).error().code, ErrorCode::no_usable_points);
  const std::vector<double> nan(9, NAN);
  EXPECT_EQ(make_working_cloud(nan.data(), 3, {}).error().code, ErrorCode::no_usable_points);
  const std::vector<double> huge = {1e200, 0, 0, -1e200, 0, 0};
  EXPECT_EQ(make_working_cloud(huge.data(), 2, {}).error().code, ErrorCode::no_usable_points);
}

TEST(WorkingCloud, ExtremeButLegalScales) {
  for (const double scale : {1e-12, 1.0, 1e12}) {
    std::vector<double> xyz = random_xyz(1000, 6);
    for (double& v : xyz) v *= scale;
    EXPECT_EQ(make_working_cloud(xyz.data(), 1000, {}).value().points.size(), 1000u) << scale;
  }
}

}  // namespace
