/// Random numbers that are the same bits on every machine and standard library: xoshiro256** (Blackman &
/// Vigna 2018) seeded by splitmix64, and normal numbers by Marsaglia's polar method with a logarithm of our
/// own (std::normal_distribution differs between libraries, std::log may differ in the last bit).
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace rfsmooth::clouds {

class Random {
 public:
  explicit Random(std::uint64_t seed);

  std::uint64_t bits();
  double uniform();                         ///< in (0, 1)
  double uniform(double low, double high);  ///< in (low, high)
  double normal();                          ///< mean 0, standard deviation 1
  Eigen::Vector3d normal3();                ///< three of them
  Eigen::Vector3d in_box(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper);
  Eigen::Vector3d direction();  ///< uniform on the unit sphere
  Eigen::Vector2d circle();     ///< uniform on the unit circle

 private:
  std::array<std::uint64_t, 4> state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace rfsmooth::clouds
