/// What `denoise` leaves of the noise of whole sensors in a room; the benchmark `sensors` has them all.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include <rfsmooth/denoise.h>

#include "clouds/scanner/sensors.h"
#include "rfs_mesh/noise/noise.h"

using namespace rfsmooth;

namespace {

double rms_off_room(const clouds::Sensor& sensor, const Positions& points) {
  double sum = 0;
  for (const Eigen::Vector3d& p : points) sum += std::pow(clouds::distance(clouds::room_of(sensor), p), 2);
  return std::sqrt(sum / double(points.size()));
}

class NoiseOfSensors : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Sensors, NoiseOfSensors, testing::Values("rings16", "kinect", "time_of_flight"),
                         [](const auto& test) { return test.param; });

TEST_P(NoiseOfSensors, AtMostHalfIsLeftOfASmallScan) {
  clouds::Sensor sensor = *clouds::find_sensor(GetParam());
  sensor.columns /= 2;
  if (sensor.rows > 100) sensor.rows /= 2;
  Positions points = clouds::look(sensor, 11).measured;
  const double before = rms_off_room(sensor, points);
  ASSERT_TRUE(rfsmooth::denoise(points.front().data(), points.size(), {}, {}));
  EXPECT_LT(rms_off_room(sensor, points), 0.5 * before);
}

// Cameras that match windows: every error is that of some twenty pixels, and only patches of many blotches
// can say which patches are too wide.
TEST(NoiseOfSensors, BlotchesOfAStereoCameraAreSmoothed) {
  const clouds::Sensor& sensor = *clouds::find_sensor("stereo");
  Positions points = clouds::look(sensor, 11).measured;
  const double before = rms_off_room(sensor, points);
  const auto report = rfsmooth::denoise(points.front().data(), points.size(), {}, {});
  ASSERT_TRUE(report);
  const double after = rms_off_room(sensor, points);
  EXPECT_LT(after / before, 0.4);
  EXPECT_LT(*report.value().noise_left / after, 4.0 / 3);
  EXPECT_GT(*report.value().noise_left / after, 2.0 / 3);
}

// A wall that lies between two depths which the camera knows, so that little noise carries its points from
// one to the other: no two walls, and no noise of a part of a step.
TEST(NoiseOfSensors, AWallAtTwoDepthsOfAKinectIsOne) {
  for (const double times : {0.1, 0.3}) {
    const clouds::Sensor sensor = clouds::scaled(*clouds::find_sensor("kinect"), times);
    Positions points = clouds::look(sensor, 11).measured;
    const double before = rms_off_room(sensor, points);
    ASSERT_TRUE(rfsmooth::denoise(points.front().data(), points.size(), {}, {}));
    EXPECT_LT(rms_off_room(sensor, points), 0.25 * before) << times;
  }
}

// Noise of more than half a step makes four layers of a wall. Narrow quadrics follow one of them or stand
// across them, as it comes: how many points there are must not decide whether the wall becomes one.
TEST(NoiseOfSensors, PiecesOfAKinectsWallAreSmoothedAlike) {
  const clouds::Sensor& sensor = *clouds::find_sensor("kinect");
  Positions all = clouds::look(sensor, 31).measured;
  for (Eigen::Vector3d& p : all) p = p.cast<float>().cast<double>();
  const auto off_axis = [](const Eigen::Vector3d& p) { return p.head<2>().norm() / p.z(); };
  std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return off_axis(a) < off_axis(b); });
  for (const std::size_t count : {3000U, 4000U, 4400U, 5000U, 6000U}) {
    ASSERT_GT(all.size(), count);
    Positions points(all.begin(), all.begin() + std::ptrdiff_t(count));
    const double before = rms_off_room(sensor, points);
    ASSERT_TRUE(rfsmooth::denoise(points.front().data(), points.size(), {}, {}));
    EXPECT_LT(rms_off_room(sensor, points), 0.2 * before) << count;
  }
}

// Fits across the edges of a room err alike on either side of them, and a few of these must not speak for all
// around. At half of the sites of this scan, whose points all err by themselves, they did.
TEST(NoiseOfSensors, EdgesAreNoNoiseThatNeighboursShare) {
  const Positions points = clouds::look(*clouds::find_sensor("half_degree"), 31).measured;
  const NoiseModel model = rfs_mesh::measure_noise(rfs_mesh::SpatialIndex(points, {}), {});
  const auto sharing = std::count_if(model.shared_at_sites.begin(), model.shared_at_sites.end(),
                                     [](double k) { return k > 1; });
  EXPECT_EQ(model.shared, 1);
  ASSERT_GT(model.sites.size(), 1000U);
  EXPECT_LT(double(sharing), 0.2 * double(model.sites.size()));
}

// Small round things with few rings on them, most of whose points have no face.
TEST(NoiseOfSensors, ABallAndAPillarKeepTheirForm) {
  const clouds::Sight sight = clouds::look(clouds::scaled(*clouds::find_sensor("rings16"), 0.3), 31);
  const clouds::Room small = {{}, clouds::hall().balls, {clouds::hall().pillars[1]}};
  Positions points = sight.measured;
  ASSERT_TRUE(rfsmooth::denoise(points.front().data(), points.size(), {}, {}));
  double before = 0, after = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (clouds::distance(small, sight.truth[i]) > 1e-6) continue;
    before += std::pow(clouds::distance(small, sight.measured[i]), 2);
    after += std::pow(clouds::distance(small, points[i]), 2);
    ++count;
  }
  ASSERT_GT(count, 400U);
  EXPECT_LT(after, before);
}

}  // namespace
