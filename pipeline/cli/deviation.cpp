#include "pipeline/cli/deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace rfsmooth::cli {

namespace io = pipeline::io;

namespace {

using Rgb = std::array<std::uint32_t, 3>;

/// Blue, cyan, green, yellow, red for 0 to 1: the scale that CloudCompare shows distances in.
Rgb ramp(double share) {
  if (!std::isfinite(share)) return {128, 128, 128};
  const double at = 4 * std::clamp(share, 0.0, 1.0);
  const auto level = [&](double from_peak) {
    return std::uint32_t(std::lround(255 * std::clamp(2 - from_peak, 0.0, 1.0)));
  };
  return {level(std::max(0.0, 4 - at)), level(std::abs(at - 2)), level(at)};
}

/// The value that stands for a packed colour in a field of that type: PCL keeps the bits in a float.
double packed(const Rgb& colour, io::Scalar type) {
  const std::uint32_t bits = colour[0] << 16 | colour[1] << 8 | colour[2];
  if (type != io::Scalar::float32) return bits;
  float same = 0;
  std::memcpy(&same, &bits, sizeof same);
  return same;
}

}  // namespace

Deviation summed_up(std::vector<double> distances) {
  distances.erase(
      std::remove_if(distances.begin(), distances.end(), [](double d) { return !std::isfinite(d); }),
      distances.end());
  const auto quantile = [&](double share) {  // the least that so many do not exceed
    const auto at = distances.begin() + std::ptrdiff_t(std::ceil(share * double(distances.size()))) - 1;
    std::nth_element(distances.begin(), at, distances.end());
    return *at;
  };
  Deviation out;
  for (const double d : distances) out.rms += d * d;
  out.rms = std::sqrt(out.rms / double(distances.size()));
  out.median = quantile(0.5);
  out.most = quantile(0.95);
  out.largest = quantile(1);
  return out;
}

void color_by_deviation(io::Cloud& cloud, const std::vector<double>& distances, double red,
                        const std::string& output, const Context& context) {
  const std::size_t n = cloud.size();
  std::vector<Rgb> colours(n);
  for (std::size_t i = 0; i < n; ++i) colours[i] = ramp(distances[i] == 0 ? 0 : distances[i] / red);
  std::vector<double> values(n);
  if (io::format_of_extension(output).value_or(cloud.format) == io::Format::pcd) {
    const auto present = io::find_field(cloud, "rgb");
    const io::Scalar type = present ? cloud.points().fields[*present].type : io::Scalar::uint32;
    for (std::size_t i = 0; i < n; ++i) values[i] = packed(colours[i], type);
    io::set_field(cloud, "rgb", type, values, context);
  } else {
    const char* const names[] = {"red", "green", "blue"};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto present = io::find_field(cloud, names[k]);
      // LAS has colours of 16 bits.
      const int times = present && cloud.points().fields[*present].type == io::Scalar::uint16 ? 256 : 1;
      for (std::size_t i = 0; i < n; ++i) values[i] = times * colours[i][k];
      io::set_field(cloud, names[k], io::Scalar::uint8, values, context);
    }
  }
  io::set_field(cloud, "deviation", io::Scalar::float32, distances, context);
}

}  // namespace rfsmooth::cli
