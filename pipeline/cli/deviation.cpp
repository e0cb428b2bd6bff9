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

/// Of a point at that distance.
Rgb colour_at(double distance, double red) {
  if (!std::isfinite(distance) || distance == 0) return ramp(distance);
  return ramp(distance < red ? distance / red : 1);
}

/// The value that stands for packed bits in a field of that type: PCL keeps them in a float.
double packed(std::uint32_t bits, io::Scalar type) {
  if (type == io::Scalar::int32) return std::int32_t(bits);
  if (type != io::Scalar::float32) return bits;
  float same = 0;
  std::memcpy(&same, &bits, sizeof same);
  return same;
}

/// Writes the colours into red, green and blue.
void paint_parts(io::Cloud& cloud, const std::vector<Rgb>& colours, const Context& context) {
  const char* const names[] = {"red", "green", "blue"};
  std::vector<double> values(colours.size());
  for (std::size_t k = 0; k < 3; ++k) {
    const auto present = io::find_field(cloud, names[k]);
    // LAS has colours of 16 bits.
    const int times = present && cloud.points().fields[*present].type == io::Scalar::uint16 ? 256 : 1;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = times * colours[i][k];
    io::set_field(cloud, names[k], io::Scalar::uint8, values, context);
  }
}

/// Writes the colours into one field, opaque where it is `rgba`, but for floats: as such they would be NaN.
void paint_packed(io::Cloud& cloud, const char* name, const std::vector<Rgb>& colours,
                  const Context& context) {
  const auto present = io::find_field(cloud, name);
  const io::Scalar type = present ? cloud.points().fields[*present].type : io::Scalar::uint32;
  const std::uint32_t alpha = std::strcmp(name, "rgba") == 0 && !io::is_float(type) ? 255U << 24 : 0;
  std::vector<double> values(colours.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& [red, green, blue] = colours[i];
    values[i] = packed(alpha | red << 16 | green << 8 | blue, type);
  }
  io::set_field(cloud, name, type, values, context);
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
  std::vector<Rgb> colours(cloud.size());
  for (std::size_t i = 0; i < colours.size(); ++i) colours[i] = colour_at(distances[i], red);
  const auto has = [&](const char* name) { return io::find_plain_field(cloud, name).has_value(); };
  const bool parts = has("red") && has("green") && has("blue"), rgb = has("rgb"), rgba = has("rgba"),
             none = !parts && !rgb && !rgba,
             pcd = io::format_of_extension(output).value_or(cloud.format) == io::Format::pcd;
  if (parts || (none && !pcd)) paint_parts(cloud, colours, context);
  if (rgb || (none && pcd)) paint_packed(cloud, "rgb", colours, context);
  if (rgba) paint_packed(cloud, "rgba", colours, context);
  io::set_field(cloud, "deviation", io::Scalar::float32, distances, context);
}

}  // namespace rfsmooth::cli
