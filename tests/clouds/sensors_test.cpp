#include "clouds/scanner/sensors.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::clouds;
using Eigen::Vector3d;

namespace {

constexpr std::uint64_t kLook = 5;
constexpr double kDegrees = 180 / M_PI;

Sensor small_camera() {
  Sensor camera;
  camera.camera = true;
  camera.columns = 160;
  camera.rows = 120;
  return camera;
}

/// The same without noise and steps.
Sensor exact(Sensor sensor) {
  sensor = scaled(sensor, 0);
  sensor.step = sensor.disparity_step = 0;
  return sensor;
}

TEST(Sensors, HaveNamesOfTheirOwnAndAreFoundByThem) {
  std::set<std::string> names;
  for (const Sensor& sensor : sensors()) {
    EXPECT_EQ(find_sensor(sensor.name), &sensor);
    EXPECT_TRUE(names.insert(std::string(sensor.name)).second) << sensor.name;
  }
  EXPECT_EQ(find_sensor("sonar"), nullptr);
}

TEST(Sensors, WithoutNoiseItsPointsLieOnTheRoom) {
  for (const Sensor& sensor : sensors()) {
    SCOPED_TRACE(std::string(sensor.name));
    const Sight sight = look(exact(sensor), kLook);
    ASSERT_GT(sight.measured.size(), 10000u);
    ASSERT_EQ(sight.measured.size(), sight.truth.size());
    for (std::size_t i = 0; i < sight.truth.size(); ++i) {
      ASSERT_LT(distance(room_of(sensor), sight.measured[i]), 1e-6);
      ASSERT_LT((sight.measured[i] - sight.truth[i]).norm(), 1e-9);
    }
  }
}

TEST(Sensors, PointsStayOnTheirRays) {
  for (const Sensor& sensor : sensors()) {
    SCOPED_TRACE(std::string(sensor.name));
    const Sight sight = look(sensor, kLook);
    for (std::size_t i = 0; i < sight.truth.size(); ++i)
      ASSERT_LT(sight.measured[i].normalized().cross(sight.truth[i].normalized()).norm(), 1e-12);
  }
}

TEST(Sensors, SameSeedSameBytesOtherSeedOthers) {
  for (const Sensor& sensor : sensors()) {
    SCOPED_TRACE(std::string(sensor.name));
    Sensor narrow = sensor;
    narrow.columns = std::min(sensor.columns, 90);
    const Positions measured = look(narrow, kLook).measured;
    EXPECT_EQ(measured, look(narrow, kLook).measured);
    EXPECT_NE(measured, look(narrow, kLook + 1).measured);
  }
}

TEST(Sensors, RaysOfLasersHaveTheStatedAngles) {
  for (const Sensor& sensor : sensors()) {
    if (sensor.camera) continue;
    SCOPED_TRACE(std::string(sensor.name));
    const Positions along = rays(sensor);
    ASSERT_EQ(along.size(), std::size_t(sensor.rows) * std::size_t(sensor.columns));
    const double between = (sensor.highest - sensor.lowest) / (sensor.rows - 1);
    for (std::size_t i = 0; i < along.size(); ++i) {
      const auto row = double(i / std::size_t(sensor.columns)),
                 column = double(i % std::size_t(sensor.columns));
      ASSERT_NEAR(along[i].norm(), 1, 1e-14);
      ASSERT_NEAR(std::asin(along[i][2]) * kDegrees, sensor.lowest + between * row, 1e-10);
      const double turn = std::atan2(along[i][1], along[i][0]) * kDegrees;
      ASSERT_NEAR(std::remainder(turn - sensor.around * column / sensor.columns, 360), 0, 1e-10);
    }
  }
}

TEST(Sensors, RaysOfCamerasFillTheStatedField) {
  for (const Sensor& sensor : sensors()) {
    if (!sensor.camera) continue;
    SCOPED_TRACE(std::string(sensor.name));
    const Positions along = rays(sensor);
    const auto columns = std::size_t(sensor.columns);
    ASSERT_EQ(along.size(), std::size_t(sensor.rows) * columns);
    const double pixel = along[1][0] - along[0][0];
    EXPECT_NEAR(2 * std::atan(along[columns - 1][0] + pixel / 2) * kDegrees, kCameraField, 1e-9);
    EXPECT_NEAR(along[columns][1] - along[0][1], pixel, 1e-12) << "pixels are square";
    EXPECT_LT((along.front() + along.back() - 2 * Vector3d::UnitZ()).norm(), 1e-12);
    for (const Vector3d& ray : along) ASSERT_EQ(ray[2], 1);
  }
}

TEST(Sensors, LasersHaveTheRingsOfTheirNames) {
  for (const int rings : {16, 32, 64, 128})
    for (const char* steps : {"", "_2mm"})
      EXPECT_EQ(find_sensor("rings" + std::to_string(rings) + steps)->rows, rings);
  const auto between = [](const char* name) {
    const Sensor& s = *find_sensor(name);
    return Vector3d((s.highest - s.lowest) / (s.rows - 1), s.around / s.columns, s.around);
  };
  EXPECT_LT((between("rings16") - Vector3d(2, 0.2, 360)).norm(), 0.001);
  EXPECT_LT((between("rings32") - Vector3d(1.3335, 0.16, 360)).norm(), 0.001);
  EXPECT_LT((between("rings64") - Vector3d(0.4254, 0.17, 360)).norm(), 0.001);
  EXPECT_LT((between("rings128") - Vector3d(0.3543, 0.3516, 360)).norm(), 0.001);
  EXPECT_LT((between("half_degree") - Vector3d(0.5, 0.5, 360)).norm(), 1e-12);
  EXPECT_LT((between("quarter_degree") - Vector3d(0.25, 0.25, 180)).norm(), 1e-12);
}

TEST(Sensors, RangesOfALaserHaveItsNoiseAndItsSteps) {
  const Sight sight = look(*find_sensor("rings16"), kLook);
  double squares = 0;
  for (std::size_t i = 0; i < sight.truth.size(); ++i)
    squares += (sight.measured[i] - sight.truth[i]).squaredNorm();
  const auto n = double(sight.truth.size());
  EXPECT_NEAR(std::sqrt(squares / n) / 0.01, 1, 5 / std::sqrt(2 * n));
  const Positions stepped = look(*find_sensor("rings16_2mm"), kLook).measured;
  ASSERT_EQ(stepped.size(), sight.measured.size());
  for (std::size_t i = 0; i < stepped.size(); ++i) {
    EXPECT_NEAR(stepped[i].norm() / 0.002, std::round(stepped[i].norm() / 0.002), 1e-9);
    EXPECT_LE((stepped[i] - sight.measured[i]).norm(), 0.001 + 1e-12);
  }
}

TEST(Sensors, DepthsOfAKinectAreThoseOfEighthsOfAPixel) {
  // An image of 640 columns has 57 degrees, so tan(28.5 degrees) is 320 pixels.
  const double pixels = 320 / std::tan(28.5 / kDegrees) * 0.075;
  for (const char* name : {"kinect", "kinect_full", "kinect_shared"}) {
    std::set<double> eighths;
    for (const Vector3d& p : look(*find_sensor(name), kLook).measured) {
      const double disparity = 8 * pixels / p[2];
      ASSERT_NEAR(disparity, std::round(disparity), 1e-9) << name;
      eighths.insert(std::round(disparity));
    }
    EXPECT_GT(eighths.size(), 50u) << name;
    EXPECT_LT(eighths.size(), 120u) << name;
  }
}

TEST(Sensors, NoiseOfAKinectGrowsWithRangeSquared) {
  Sensor kinect = *find_sensor("kinect");
  kinect.disparity_step = 0;
  const Sight sight = look(kinect, kLook);
  double near_squares = 0, near_count = 0, far_squares = 0, far_count = 0;
  for (std::size_t i = 0; i < sight.truth.size(); ++i) {
    const double z = sight.truth[i][2],
                 off = (sight.measured[i][2] - z) / (0.0012 + 0.0019 * std::pow(z - 0.4, 2));
    (z < 2.5 ? near_squares : far_squares) += off * off;
    (z < 2.5 ? near_count : far_count) += 1;
  }
  ASSERT_GT(std::min(near_count, far_count), 5000);
  EXPECT_NEAR(std::sqrt(near_squares / near_count), 1, 5 / std::sqrt(2 * near_count));
  EXPECT_NEAR(std::sqrt(far_squares / far_count), 1, 5 / std::sqrt(2 * far_count));
}

TEST(Sensors, DepthsOfATimeOfFlightCameraAreWholeMillimetres) {
  const Sight sight = look(*find_sensor("time_of_flight"), kLook);
  double squares = 0;
  for (std::size_t i = 0; i < sight.truth.size(); ++i) {
    const double z = sight.measured[i][2];
    ASSERT_NEAR(1000 * z, std::round(1000 * z), 1e-9);
    squares += std::pow(z - sight.truth[i][2], 2);
  }
  const auto n = double(sight.truth.size());
  EXPECT_NEAR(std::sqrt(squares / n), std::sqrt(0.004 * 0.004 + 0.001 * 0.001 / 12), 0.0001);
}

// Binomial weights of order n, applied twice, are those of order 2 n: so correlate two pixels k apart.
TEST(Sensors, DisparitiesOfMatchedWindowsAreSharedByNeighbours) {
  Sensor stereo = small_camera();
  stereo.disparity = 0.04;
  stereo.shared = 16;
  const double pixels = 320 / std::tan(28.5 / kDegrees) * kBaseline;
  const Sight sight = look(stereo, kLook);
  ASSERT_EQ(sight.truth.size(), 160u * 120u) << "every ray of this camera meets something";
  std::vector<double> off;
  for (std::size_t i = 0; i < sight.truth.size(); ++i)
    off.push_back((pixels / sight.measured[i][2] - pixels / sight.truth[i][2]) / 0.04);
  const auto correlation = [&](std::size_t across, std::size_t down) {
    double sum = 0, count = 0;
    for (std::size_t row = 0; row + down < 120; ++row)
      for (std::size_t column = 0; column + across < 160; ++column, ++count)
        sum += off[row * 160 + column] * off[(row + down) * 160 + column + across];
    return sum / count;
  };
  const auto stated = [](int apart) {  // C(32, 16 - apart) / C(32, 16)
    double ratio = 1;
    for (int k = 1; k <= apart; ++k) ratio *= double(16 - k + 1) / (16 + k);
    return ratio;
  };
  // About 19200 / (pi 16) = 380 numbers are independent: five standard errors are a quarter or less.
  EXPECT_NEAR(correlation(0, 0), 1, 0.35);
  for (const int apart : {1, 3, 6})
    for (const bool down : {false, true}) {
      const auto far = std::size_t(apart);
      EXPECT_NEAR(correlation(down ? 0 : far, down ? far : 0) / correlation(0, 0), stated(apart), 0.15);
    }
  EXPECT_NEAR(correlation(40, 0), 0, 0.3);
}

TEST(Sensors, ScalingChangesTheNoiseAndLeavesTheSteps) {
  const Sensor& kinect = *find_sensor("kinect");
  const Sensor twice = scaled(kinect, 2);
  EXPECT_EQ(twice.sigma, 2 * kinect.sigma);
  EXPECT_EQ(twice.growth, 2 * kinect.growth);
  EXPECT_EQ(twice.disparity_step, kinect.disparity_step);
  EXPECT_EQ(scaled(*find_sensor("stereo"), 2).disparity, 0.08);
}

TEST(Sensors, MeasuresThatAreNoneAreLeftOut) {
  Sensor blind = small_camera();
  blind.sigma = 2;
  const Sight sight = look(blind, kLook);
  EXPECT_LT(sight.measured.size(), 160u * 120u);
  EXPECT_GT(sight.measured.size(), 1000u);
  for (const Vector3d& p : sight.measured) EXPECT_GE(p[2], 0.2);
}

}  // namespace
