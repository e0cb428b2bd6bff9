#include "pipeline/io/point_fields.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pipeline/io/table/table_walk.h"

namespace rfsmooth::pipeline::io {

namespace {

std::uint8_t level(double value) {
  return std::isfinite(value) ? std::uint8_t(std::lround(std::clamp(value, 0.0, 255.0))) : 0;
}

/// What makes levels of 0 to 255 of the values: floats go to 1, unless a value says that they go to 255 or to
/// 65535, as numbers of a text do; 16 bits of LAS go to 65535, unless the program that wrote them used the
/// lower 8.
double to_levels(Scalar type, const std::array<std::vector<double>, 3>& colors) {
  const auto any_above = [&](double most) {
    return std::any_of(colors.begin(), colors.end(), [&](const std::vector<double>& c) {
      return std::any_of(c.begin(), c.end(), [&](double value) { return value > most; });
    });
  };
  if (is_float(type) && !any_above(1)) return 255;
  return (is_float(type) || type == Scalar::uint16) && any_above(255) ? 255.0 / 65535 : 1;
}

/// The colours of one field of packed bits.
std::vector<Rgb> unpacked_colors(const Cloud& cloud, std::size_t field, const Context& context) {
  std::vector<Rgb> colors;
  for (const std::uint32_t bits : packed_colors(cloud, field, context))
    colors.push_back(
        {std::uint8_t(bits >> 16 & 255), std::uint8_t(bits >> 8 & 255), std::uint8_t(bits & 255)});
  return colors;
}

}  // namespace

std::vector<std::uint32_t> packed_colors(const Cloud& cloud, std::size_t field, const Context& context) {
  const Table& points = cloud.points();
  const Scalar type = points.fields[field].type;
  const bool four = size_of(type) == sizeof(std::uint32_t);
  std::vector<std::uint32_t> packed(points.count);
  if (four && !points.text) {  // a colour with alpha is a NaN as a float: a double would not have its bits
    const Locator locate(points);
    for (std::size_t i = 0; i < packed.size(); ++i)
      std::memcpy(&packed[i], locate(points.row(i).data(), field), sizeof packed[i]);
    return packed;
  }
  const std::vector<double> values = field_values(cloud, field, context);
  for (std::size_t i = 0; i < packed.size(); ++i) {
    char stored[8];
    store(four ? type : Scalar::int64, stored, values[i]);
    std::memcpy(&packed[i], stored, sizeof packed[i]);
  }
  return packed;
}

std::vector<Rgb> colors_of(const Cloud& cloud, const Context& context) {
  const std::array fields = {find_plain_field(cloud, "red"), find_plain_field(cloud, "green"),
                             find_plain_field(cloud, "blue")};
  if (fields[0] && fields[1] && fields[2]) {
    std::array<std::vector<double>, 3> values;
    for (std::size_t k = 0; k < 3; ++k) values[k] = field_values(cloud, *fields[k], context);
    const double full = to_levels(cloud.points().fields[*fields[0]].type, values);
    std::vector<Rgb> colors(cloud.size());
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < colors.size(); ++i) colors[i][k] = level(values[k][i] * full);
    return colors;
  }
  for (const char* name : {"rgb", "rgba"})
    if (const auto field = find_plain_field(cloud, name)) return unpacked_colors(cloud, *field, context);
  return {};
}

bool has_normals(const Cloud& cloud) {
  return find_field(cloud, kPlyNormal[0]) || find_field(cloud, kPcdNormal[0]);
}

std::vector<double> normals_of(const Cloud& cloud, const Context& context) {
  for (const NormalNames& names : {kPlyNormal, kPcdNormal}) {
    std::vector<double> normals(3 * cloud.size());
    bool all = true;
    for (std::size_t axis = 0; axis < 3 && all; ++axis) {
      const auto field = find_plain_field(cloud, names[axis]);
      all = field.has_value();
      if (!all) break;
      const std::vector<double> values = field_values(cloud, *field, context);
      for (std::size_t i = 0; i < values.size(); ++i) normals[3 * i + axis] = values[i];
    }
    if (all) return normals;
  }
  return {};
}

}  // namespace rfsmooth::pipeline::io
