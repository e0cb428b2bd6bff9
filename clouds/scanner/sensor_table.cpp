#include <iterator>
#include <utility>

#include "clouds/scanner/sensors.h"

namespace rfsmooth::clouds {

namespace {

/// A laser with noise of 3, 10 and 30 mm, all around unless said otherwise.
Sensor laser(std::string_view name, std::string_view says, int rows, double lowest, double highest,
             int columns, double around = 360) {
  Sensor s;
  s.name = name;
  s.says = says;
  s.rows = rows;
  s.lowest = lowest;
  s.highest = highest;
  s.columns = columns;
  s.around = around;
  s.sigma = 0.01;
  s.levels = {0.3, 1, 3};
  return s;
}

/// The same with ranges in whole steps, as most lasers send them.
Sensor in_steps(Sensor s, std::string_view name, double step) {
  s.name = name;
  s.step = step;
  return s;
}

Sensor camera(std::string_view name, std::string_view says, int columns, int rows) {
  Sensor s;
  s.name = name;
  s.says = says;
  s.camera = true;
  s.columns = columns;
  s.rows = rows;
  return s;
}

/// Disparities in eighths of a pixel, after the noise of Nguyen et al.
Sensor kinect(std::string_view name, std::string_view says, int columns, int rows, int shared) {
  Sensor s = camera(name, says, columns, rows);
  s.sigma = 0.0012;
  s.growth = 0.0019;
  s.disparity_step = 1.0 / 8;
  s.shared = shared;
  s.levels = {0.3, 1};  // steps are more than the noise at 0.3
  return s;
}

Sensor time_of_flight(std::string_view name, std::string_view says, int columns, int rows) {
  Sensor s = camera(name, says, columns, rows);
  s.sigma = 0.004;
  s.step = 0.001;
  return s;
}

Sensor stereo(std::string_view name, std::string_view says, int columns, int rows, double disparity,
              int shared, std::vector<double> levels = {1}) {
  Sensor s = camera(name, says, columns, rows);
  s.disparity = disparity;
  s.shared = shared;
  s.levels = std::move(levels);
  return s;
}

std::vector<Sensor> make_sensors() {
  std::vector<Sensor> list = {
      laser("rings16", "spinning laser, 16 rings, 2 degrees apart", 16, -15, 15, 1800),
      laser("rings32", "spinning laser, 32 rings, 1.33 degrees apart", 32, -30.67, 10.67, 2250),
      laser("rings64", "spinning laser, 64 rings, 0.43 degrees apart", 64, -24.8, 2, 2118),
      laser("rings128", "spinning laser, 128 rings, 0.35 degrees apart", 128, -22.5, 22.5, 1024),
      laser("half_degree", "terrestrial scanner, half a degree between rays", 200, -40, 59.5, 720),
      laser("quarter_degree", "terrestrial scanner, a quarter of a degree, half a turn", 400, -40, 59.75, 720,
            180)};
  std::size_t laser_row = 0;
  for (const std::string_view name :
       {"rings16_2mm", "rings32_2mm", "rings64_2mm", "rings128_2mm", "half_degree_2mm", "quarter_degree_2mm"})
    list.push_back(in_steps(list[laser_row++], name, 0.002));
  const Sensor cameras[] = {
      kinect("kinect", "every second pixel of a Kinect, disparities in eighths of a pixel", 320, 240, 0),
      kinect("kinect_full", "every pixel of a Kinect", 640, 480, 0),
      kinect("kinect_shared", "the same as kinect, errors shared over 1.5 pixels", 320, 240, 9),
      time_of_flight("time_of_flight", "camera with noise of 4 mm, depths in whole millimetres", 320, 240),
      stereo("stereo", "matched windows: disparities off by 0.04 pixels, shared over 2", 320, 240, 0.04, 16,
             {0.5, 1, 4}),
      stereo("stereo_small", "small windows: errors shared over 1 pixel", 320, 240, 0.04, 4),
      stereo("stereo_large", "large windows: errors shared over 4 pixels", 320, 240, 0.04, 64),
      stereo("stereo_full", "a larger image: 0.03 pixels, shared over 3", 640, 480, 0.03, 36),
  };
  list.insert(list.end(), std::begin(cameras), std::end(cameras));
  return list;
}

}  // namespace

const std::vector<Sensor>& sensors() {
  static const std::vector<Sensor> list = make_sensors();
  return list;
}

const Sensor* find_sensor(std::string_view name) {
  for (const Sensor& sensor : sensors())
    if (sensor.name == name) return &sensor;
  return nullptr;
}

}  // namespace rfsmooth::clouds
