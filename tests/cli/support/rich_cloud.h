/// A cloud with the fields that other tools lose (rgb, intensity, label, a double time) as PLY or PCD bytes.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace rfsmooth::test {

/// x y z of float or double, rgb (float of packed bytes), intensity (float), label (uint32), time (double).
struct RichCloud {
  std::vector<double> xyz;
  bool pcd = false, doubles = false;

  std::size_t size() const { return xyz.size() / 3; }
  std::size_t coordinate_bytes() const { return doubles ? 24 : 12; }
  std::size_t row_bytes() const { return coordinate_bytes() + 20; }
  const char* name() const { return pcd ? "in.pcd" : "in.ply"; }
  const char* output() const { return pcd ? "out.pcd" : "out.ply"; }

  /// The rows before that one, and those from it on.
  std::pair<RichCloud, RichCloud> cut_at(std::size_t row) const {
    RichCloud first = *this, second = *this;
    first.xyz.resize(3 * row);
    second.xyz.erase(second.xyz.begin(), second.xyz.begin() + std::ptrdiff_t(3 * row));
    return {first, second};
  }

  std::string header() const {
    const std::string n = std::to_string(size());
    if (pcd) {
      const std::string c = doubles ? "8 8 8" : "4 4 4";
      return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb intensity label "
             "time\nSIZE " +
             c + " 4 4 4 8\nTYPE F F F F F U F\nCOUNT 1 1 1 1 1 1 1\nWIDTH " + n +
             "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary\n";
    }
    const std::string c = std::string("property ") + (doubles ? "double" : "float");
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + n + "\n" + c + " x\n" + c + " y\n" + c +
           " z\nproperty float rgb\nproperty float intensity\nproperty uint label\nproperty double "
           "time\nend_header\n";
  }

  std::string bytes() const {
    std::string out = header();
    const auto add = [&](const auto& value) {
      out.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (doubles)
          add(xyz[3 * i + axis]);
        else
          add(float(xyz[3 * i + axis]));
      }
      // Packed colours are floats of any bits, signalling NaNs too.
      add(std::uint32_t(i * 2654435761u) | (i % 7 == 0 ? 0x7f800001u : 0u));
      add(float(i) * 0.37f);
      add(std::uint32_t(i * 40503u + 4000000000u));
      add(1.7e9 + double(i) * 1e-6);
    }
    return out;
  }

  /// Coordinate `axis` of row `i` of a file of this layout.
  double coordinate(const std::string& file, std::size_t i, std::size_t axis) const {
    const char* at = file.data() + header().size() + i * row_bytes() + axis * (doubles ? 8 : 4);
    if (!doubles) {
      float value = 0;
      std::memcpy(&value, at, 4);
      return double(value);
    }
    double value = 0;
    std::memcpy(&value, at, 8);
    return value;
  }
  std::string row(const std::string& file, std::size_t i) const {
    return file.substr(header().size() + i * row_bytes(), row_bytes());
  }
  /// What must stay of row `i`.
  std::string extras(const std::string& file, std::size_t i) const {
    return row(file, i).substr(coordinate_bytes());
  }
};

/// n points on a bumpy height field over [0, 10)^2, moved by Gaussian noise of a third of their spacing.
inline RichCloud bumpy(std::size_t n, bool pcd, bool doubles = false) {
  std::mt19937_64 engine(4);
  std::uniform_real_distribution<double> place(0, 10);
  std::normal_distribution<double> noise(0, 10 / std::sqrt(double(n)) / 3);
  RichCloud cloud;
  cloud.pcd = pcd;
  cloud.doubles = doubles;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = place(engine), y = place(engine);
    cloud.xyz.insert(cloud.xyz.end(),
                     {x + noise(engine), y + noise(engine), std::sin(x) * std::cos(y) * 0.5 + noise(engine)});
  }
  return cloud;
}

}  // namespace rfsmooth::test
