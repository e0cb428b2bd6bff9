/// Small clouds as file bytes.
#pragma once

#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace rfsmooth::test {

/// A binary PLY with x y z float, a float field, and a 4-byte field of arbitrary bits.
struct BinaryPly {
  static constexpr std::size_t kRow = 20;
  std::string extra = "intensity";
  std::vector<float> xyz;

  std::size_t size() const { return xyz.size() / 3; }
  std::string header() const {
    return "ply\nformat binary_little_endian 1.0\ncomment made by a test\nelement vertex " +
           std::to_string(size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty float " + extra +
           "\nproperty uint label\nend_header\n";
  }
  std::string bytes() const {
    std::string out = header();
    for (std::size_t i = 0; i < size(); ++i) {
      const float value = float(i) * 0.1f;
      const auto label = std::uint32_t(i * 2654435761u);
      out.append(reinterpret_cast<const char*>(&xyz[3 * i]), 12);
      out.append(reinterpret_cast<const char*>(&value), 4);
      out.append(reinterpret_cast<const char*>(&label), 4);
    }
    return out;
  }
};

/// rows x columns points of a unit-spaced grid in the plane z = 0, moved by Gaussian noise of 0.2.
inline BinaryPly noisy_sheet(int rows, int columns, const std::string& extra = "intensity") {
  std::mt19937_64 engine(9);
  std::normal_distribution<double> noise(0, 0.2);
  BinaryPly cloud;
  cloud.extra = extra;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      for (const int c : {i, j, 0}) cloud.xyz.push_back(float(c + noise(engine)));
  return cloud;
}

inline BinaryPly noisy_plane(int side, const std::string& extra = "intensity") {
  return noisy_sheet(side, side, extra);
}

}  // namespace rfsmooth::test
