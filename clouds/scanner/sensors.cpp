#include "clouds/scanner/sensors.h"

#include <cmath>

#include "clouds/shapes/random.h"

namespace rfsmooth::clouds {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kNearestMeasure = 0.2, kFarthestMeasure = 50;  // metres

/// Cosine and sine of an angle in degrees from + - * / alone: libraries differ in the last bit.
Vector2d turned(double degrees) {
  constexpr double kToRadians = 0.017453292519943295;
  const double quarters = std::round(degrees / 90);
  const double x = (degrees - 90 * quarters) * kToRadians;  // at most pi / 4: twenty terms reach 1e-21
  Vector2d at(0, 0);
  double term = 1;
  for (int k = 0; k < 20; ++k) {
    at[k % 2] += k % 4 < 2 ? term : -term;
    term *= x / (k + 1);
  }
  switch (((int(quarters) % 4) + 4) % 4) {
    case 1:
      return {-at[1], at[0]};
    case 2:
      return -at;
    case 3:
      return {at[1], -at[0]};
    default:
      return at;
  }
}

/// Pixels of an image with so many columns per unit of x / z.
double focal_length(int columns) {
  const Vector2d half = turned(kCameraField / 2);
  return 0.5 * columns * half[0] / half[1];
}

std::vector<double> binomial_weights(int order) {
  std::vector<double> weights = {1};
  double squares = 1;
  for (int k = 0; k < order; ++k) {
    weights.push_back(weights.back() * (order - k) / (k + 1));
    squares += weights.back() * weights.back();
  }
  for (double& w : weights) w /= std::sqrt(squares);
  return weights;
}

/// Of each ray a number of mean 0 and standard deviation 1, the same for near neighbours if they are shared:
/// independent draws on a grid that is larger by the order, summed along one axis, then the other.
std::vector<double> shared_draws(const Sensor& sensor, Random& random) {
  const std::vector<double> weights = binomial_weights(sensor.shared);
  const auto across = std::size_t(sensor.columns), down = std::size_t(sensor.rows), n = weights.size();
  const std::size_t wide = across + n - 1;
  std::vector<double> drawn(wide * (down + n - 1));
  for (double& d : drawn) d = random.normal();
  std::vector<double> summed_down(wide * down), summed(across * down);
  for (std::size_t i = 0; i < summed_down.size(); ++i)
    for (std::size_t k = 0; k < n; ++k) summed_down[i] += weights[k] * drawn[i + k * wide];
  for (std::size_t i = 0; i < summed.size(); ++i)
    for (std::size_t k = 0; k < n; ++k)
      summed[i] += weights[k] * summed_down[i / across * wide + i % across + k];
  return summed;
}

double to_step(double length, double step) {
  return step > 0 ? step * std::round(length / step) : length;
}

/// What the sensor makes of a range or depth, `draw` being standard normal.
double measure(const Sensor& sensor, double truth, double draw) {
  constexpr double kWhereKinectsAreBest = 0.4;  // metres
  const double off = truth - kWhereKinectsAreBest;
  double length = truth + (sensor.sigma + sensor.growth * off * off) * draw;
  if (sensor.disparity > 0 || sensor.disparity_step > 0) {
    const double pixels = focal_length(kDisparityColumns) * kBaseline;  // of disparity at one metre
    length = pixels / to_step(pixels / length + sensor.disparity * draw, sensor.disparity_step);
  }
  return to_step(length, sensor.step);
}

Positions laser_rays(const Sensor& sensor) {
  Positions out;
  for (int row = 0; row < sensor.rows; ++row) {
    const double share = sensor.rows > 1 ? double(row) / (sensor.rows - 1) : 0;
    const Vector2d up = turned(sensor.lowest + share * (sensor.highest - sensor.lowest));
    for (int column = 0; column < sensor.columns; ++column) {
      const Vector2d around = turned(sensor.around * column / sensor.columns);
      out.emplace_back(up[0] * around[0], up[0] * around[1], up[1]);
    }
  }
  return out;
}

Positions camera_rays(const Sensor& sensor) {
  const double focal = focal_length(sensor.columns);
  Positions out;
  for (int row = 0; row < sensor.rows; ++row)
    for (int column = 0; column < sensor.columns; ++column)
      out.emplace_back((column - 0.5 * (sensor.columns - 1)) / focal, (row - 0.5 * (sensor.rows - 1)) / focal,
                       1);
  return out;
}

}  // namespace

Sensor scaled(Sensor sensor, double times) {
  for (double* noise : {&sensor.sigma, &sensor.growth, &sensor.disparity}) *noise *= times;
  return sensor;
}

const Room& room_of(const Sensor& sensor) {
  return sensor.camera ? corner() : hall();
}

Positions rays(const Sensor& sensor) {
  return sensor.camera ? camera_rays(sensor) : laser_rays(sensor);
}

Sight look(const Sensor& sensor, std::uint64_t seed) {
  Random random(seed);
  const Positions along = rays(sensor);
  const std::vector<double> draws = shared_draws(sensor, random);
  Sight sight;
  for (std::size_t i = 0; i < along.size(); ++i) {
    const double truth = meet(room_of(sensor), along[i]);
    if (std::isinf(truth)) continue;
    const double measured = measure(sensor, truth, draws[i]);
    if (!(measured >= kNearestMeasure && measured <= kFarthestMeasure)) continue;
    sight.measured.emplace_back(measured * along[i]);
    sight.truth.emplace_back(truth * along[i]);
  }
  return sight;
}

}  // namespace rfsmooth::clouds
