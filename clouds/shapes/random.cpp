#include "clouds/shapes/random.h"

#include <cmath>

namespace rfsmooth::clouds {

namespace {

std::uint64_t rotate_left(std::uint64_t x, int by) {
  return (x << by) | (x >> (64 - by));
}

/// ln(x), x > 0, within a few units of the last place, from + - * / alone.
double portable_log(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // [0.5, 1)
  if (m < 0.7071067811865476) {
    m *= 2;
    --exponent;
  }
  const double s = (m - 1) / (m + 1), s2 = s * s;  // |s| < 0.172: 12 terms reach 1e-19
  double sum = 0;
  for (int k = 23; k >= 1; k -= 2) sum = sum * s2 + 1.0 / k;
  return exponent * 0.6931471805599453 + 2 * s * sum;
}

}  // namespace

Random::Random(std::uint64_t seed) : state_() {
  for (std::uint64_t& word : state_) {
    std::uint64_t z = (seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    word = z ^ (z >> 31);
  }
}

std::uint64_t Random::bits() {
  auto& s = state_;
  const std::uint64_t out = rotate_left(s[1] * 5, 7) * 9, t = s[1] << 17;
  s[2] ^= s[0];
  s[3] ^= s[1];
  s[1] ^= s[2];
  s[0] ^= s[3];
  s[2] ^= t;
  s[3] = rotate_left(s[3], 45);
  return out;
}

double Random::uniform() {
  return (double(bits() >> 12) + 0.5) * 0x1p-52;
}

double Random::uniform(double low, double high) {
  return low + (high - low) * uniform();
}

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  for (;;) {
    const double x = uniform(-1, 1);
    const double y = uniform(-1, 1);
    const double s = x * x + y * y;
    if (s >= 1 || s == 0) continue;
    const double scale = std::sqrt(-2 * portable_log(s) / s);
    spare_ = y * scale;
    has_spare_ = true;
    return x * scale;
  }
}

Eigen::Vector3d Random::normal3() {
  Eigen::Vector3d v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = normal();
  return v;
}

Eigen::Vector3d Random::in_box(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  Eigen::Vector3d v;
  for (int axis = 0; axis < 3; ++axis) v[axis] = uniform(lower[axis], upper[axis]);
  return v;
}

Eigen::Vector3d Random::direction() {
  for (;;) {
    const Eigen::Vector3d v = in_box(Eigen::Vector3d::Constant(-1), Eigen::Vector3d::Constant(1));
    const double s = v.squaredNorm();
    if (s < 1 && s > 1e-6) return v / std::sqrt(s);
  }
}

Eigen::Vector2d Random::circle() {
  for (;;) {
    Eigen::Vector2d v;
    v[0] = uniform(-1, 1);
    v[1] = uniform(-1, 1);
    const double s = v.squaredNorm();
    if (s < 1 && s > 1e-6) return v / std::sqrt(s);
  }
}

}  // namespace rfsmooth::clouds
