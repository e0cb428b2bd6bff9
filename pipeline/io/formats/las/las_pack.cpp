#include "pipeline/io/formats/las/las_pack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/parallel.h"
#include "pipeline/io/formats/las/las_fields.h"
#include "pipeline/io/formats/las/las_parts.h"
#include "pipeline/io/formats/las/las_scale.h"
#include "pipeline/io/point_fields.h"

namespace rfsmooth::pipeline::io {
namespace las {
namespace {

constexpr double kDegreesPerStep = 0.006;

// Those from low to high.
struct WholeNumbers {
  double low, high;
};
constexpr WholeNumbers kOf8Bits = {0, 255}, kOf16Bits = {0, 65535}, kOf16BitsSigned = {-32768, 32767};

// A place of a point of formats 6 to 8 for a plain field of that name, and what it can hold.
struct Place {
  std::string_view name;
  std::string_view field;               // stored
  std::optional<WholeNumbers> numbers;  // none: any number, whole or not
  int shift = 0, bits = 0;
  double times = 1;
};

std::vector<Place> places() {
  std::vector<Place> out = {{"intensity", "intensity", kOf16Bits},
                            {"classification", "classification", kOf8Bits},
                            {"user_data", "user_data", kOf8Bits},
                            {"point_source_id", "point_source_id", kOf16Bits},
                            {"scan_angle", "scan_angle", kOf16BitsSigned, 0, 0, 1 / kDegreesPerStep},
                            {"scan_angle_rank", "scan_angle", kOf16BitsSigned, 0, 0, 1 / kDegreesPerStep},
                            {"gps_time", "gps_time", std::nullopt},
                            {"nir", "nir", kOf16Bits}};
  for (const Part& p : kNewParts)
    out.push_back({p.name, p.of, WholeNumbers{0, double((1 << p.bits) - 1)}, p.shift, p.bits});
  for (const std::string_view c : kColours) out.push_back({c, c, kOf16Bits});
  return out;
}

// A plain field that has found its place.
struct Taken {
  Place place;
  std::vector<double> values;
};

bool are_all(const std::vector<double>& values, const WholeNumbers& of) {
  return std::all_of(values.begin(), values.end(),
                     [&](double v) { return v >= of.low && v <= of.high && v == std::nearbyint(v); });
}

// The name of a place that a field's name stands for: a colour's in any case, or the field's own.
std::string_view plain_name(const Cloud& plain, std::size_t f) {
  for (const std::string_view colour : kColours)
    if (find_field(plain, colour) == f) return colour;
  return plain.points().fields[f].name;
}

std::optional<Taken> place_of(const Cloud& plain, std::size_t f, const std::vector<Taken>& before,
                              const Context& context) {
  const Field& field = plain.points().fields[f];
  const std::string_view name = plain_name(plain, f);
  for (const Place& place : places()) {
    if (place.name != name || !field.is_plain()) continue;
    const bool used = std::any_of(before.begin(), before.end(), [&](const Taken& t) {
      return t.place.field == place.field && t.place.shift == place.shift;
    });
    if (used) return std::nullopt;
    Taken taken{place, field_values(plain, f, context)};
    if (!place.numbers) return is_float(field.type) ? std::optional(taken) : std::nullopt;
    if (place.times != 1) {
      for (double& v : taken.values) v = std::nearbyint(v * place.times);
    } else if (is_colour(place.name) && field.type != Scalar::uint16 && are_all(taken.values, kOf8Bits)) {
      for (double& v : taken.values) v *= 256;  // as the specification asks of colours of 8 bits
    }
    return are_all(taken.values, *place.numbers) ? std::optional(taken) : std::nullopt;
  }
  return std::nullopt;
}

// Red, green and blue out of PCL's field rgb, 4 bytes.
void take_packed(const Cloud& plain, std::size_t f, const Context& context, std::vector<Taken>& taken) {
  const std::vector<std::uint32_t> packed = packed_colors(plain, f, context);
  for (std::size_t c = 0; c < 3; ++c) {
    Taken colour{{kColours[c], kColours[c], kOf16Bits}, {}};
    for (const std::uint32_t bits : packed) colour.values.push_back(256.0 * (bits >> (16 - 8 * c) & 255));
    taken.push_back(std::move(colour));
  }
}

// A header of LAS 1.4 without points. Deterministic: no date.
std::string new_header(int point_format) {
  std::string head(header_size(4), '\0');
  head.replace(0, 4, "LASF");
  put_number<std::uint16_t>(head, kEncodingAt, 16);  // formats 6 to 10: a coordinate system, if any, is WKT
  put_number<std::uint8_t>(head, kMajorAt, 1);
  put_number<std::uint8_t>(head, kMinorAt, 4);
  head.replace(kSystemAt, 5, "OTHER");
  head.replace(kSoftwareAt, 8, "rfsmooth");
  put_number(head, kHeaderSizeAt, std::uint16_t(head.size()));
  put_number(head, kPointsAt, std::uint32_t(head.size()));
  put_number(head, kPointFormatAt, std::uint8_t(point_format));
  put_number(head, kRowSizeAt, std::uint16_t(row_size(point_format)));
  return head;
}

// One scale for all axes; an offset, a round number, only where it is needed.
void choose_scale(std::vector<Field>& fields, const std::vector<double>& xyz) {
  constexpr double kSteps = 1e9, kMostAway = 2e9, kRoundSteps = 1e8;
  std::array<double, 3> low{}, high{};
  double extent = 0, far = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t k = axis; k < xyz.size(); k += 3) {
      low[axis] = k == axis ? xyz[k] : std::min(low[axis], xyz[k]);
      high[axis] = k == axis ? xyz[k] : std::max(high[axis], xyz[k]);
    }
    extent = std::max(extent, high[axis] - low[axis]);
    far = std::max({far, std::abs(low[axis]), std::abs(high[axis])});
  }
  // One place: as fine as double numbers are there.
  const double scale = extent > 0 ? decimal_scale(extent, kSteps) : decimal_scale(far, 1e15);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    fields[axis].scale = scale;
    const bool needed = std::max(std::abs(low[axis]), std::abs(high[axis])) > kMostAway * scale;
    const double unit = kRoundSteps * scale;
    fields[axis].offset = needed ? std::nearbyint((low[axis] / 2 + high[axis] / 2) / unit) * unit : 0;
  }
}

// Which field goes where.
struct Sorted {
  std::vector<Taken> taken;
  std::vector<std::size_t> extra;  // fields that become extra bytes

  bool has(std::string_view name) const {
    return std::any_of(taken.begin(), taken.end(), [&](const Taken& t) { return t.place.name == name; });
  }
  int point_format() const { return has("nir") ? 8 : has("red") || has("green") || has("blue") ? 7 : 6; }
};

Sorted sort_fields(const Cloud& plain, const Context& context) {
  Sorted out;
  const std::vector<Field>& fields = plain.points().fields;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const bool packed = find_field(plain, "rgb") == f && fields[f].is_plain() && size_of(fields[f].type) == 4;
    if (std::find(plain.xyz.begin(), plain.xyz.end(), f) != plain.xyz.end()) continue;
    if (auto place = place_of(plain, f, out.taken, context))
      out.taken.push_back(std::move(*place));
    else if (packed && !find_field(plain, "red") && !out.has("red"))
      take_packed(plain, f, context, out.taken);
    else
      out.extra.push_back(f);
  }
  return out;
}

// The fields of the new points: the standard ones and the extra ones, whose names are none of those.
std::vector<Field> new_fields(const std::vector<Field>& from, const Sorted& sorted) {
  std::vector<Field> fields = standard_fields(sorted.point_format());
  const std::vector<Field> standard = fields;
  for (const std::size_t f : sorted.extra) {
    Field field{from[f].name, from[f].type};
    const auto taken = [&](const std::vector<Field>& by) {
      return std::any_of(by.begin(), by.end(), [&](const Field& other) { return other.name == field.name; });
    };
    if (taken(standard))
      for (std::size_t more = 1; taken(fields) || taken(from); ++more)
        field.name = from[f].name.substr(0, kLongestName - more) + std::string(more, '_');
    fields.push_back(std::move(field));
  }
  return fields;
}

std::vector<std::size_t> offsets_of(const Table& table) {
  std::vector<std::size_t> at;
  for (std::size_t f = 0; f <= table.fields.size(); ++f) at.push_back(table.offset_of(f));
  return at;
}

std::size_t index_of(const std::vector<Field>& fields, std::string_view name) {
  std::size_t f = 0;
  while (fields.at(f).name != name) ++f;
  return f;
}

// Fills the rows of `points`, whose fields are set.
void fill_rows(Table& points, const Table& from, const std::vector<double>& xyz, const Sorted& sorted,
               const Context& context) {
  const std::vector<std::size_t> at = offsets_of(points), from_at = offsets_of(from);
  const std::size_t standard = points.fields.size() - sorted.extra.size();
  const std::size_t bit_fields = at[index_of(points.fields, "bit_fields")];
  const bool returns = sorted.has("return_number") || sorted.has("number_of_returns");
  std::vector<std::size_t> target;
  for (const Taken& t : sorted.taken) target.push_back(index_of(points.fields, t.place.field));
  points.data.assign(at.back() * points.count, '\0');
  for_each_index(context, points.count, [&](std::size_t i) {
    char* row = points.data.data() + i * at.back();
    for (std::size_t axis = 0; axis < 3; ++axis)
      store(points.fields[axis], row + at[axis], xyz[3 * i + axis]);
    if (!returns) row[bit_fields] = 0x11;  // the first return of one
    for (std::size_t k = 0; k < target.size(); ++k) {
      const Place& place = sorted.taken[k].place;
      char* p = row + at[target[k]];
      const double value = sorted.taken[k].values[i];
      if (place.bits > 0)
        *p = char(std::uint8_t(*p) | unsigned(value) << place.shift);
      else
        store(points.fields[target[k]].type, p, value);
    }
    for (std::size_t k = 0; k < sorted.extra.size(); ++k)
      std::memcpy(row + at[standard + k], from.row(i).data() + from_at[sorted.extra[k]],
                  size_of(from.fields[sorted.extra[k]].type));
  });
}

// How much of a text a record of at most `most` bytes takes: whole lines, or whole characters (UTF-8) of a
// line that is longer. More than 0.
std::size_t part_for_record(std::string_view text, std::size_t most) {
  if (text.size() <= most) return text.size();
  if (const std::size_t end = text.rfind('\n', most - 1); end != std::string_view::npos) return end + 1;
  constexpr std::size_t kLongestCharacter = 4;
  const auto continues = [&](std::size_t at) { return (std::uint8_t(text[at]) & 0xC0) == 0x80; };
  std::size_t part = most;
  while (part + kLongestCharacter > most + 1 && continues(part)) --part;
  return continues(part) ? most : part;  // no UTF-8
}

// Comments, one a line, as records of text.
void append_texts(std::string& head, const std::vector<Note>& notes) {
  constexpr std::string_view kComment = "comment ";
  constexpr std::size_t kMost = 65535;
  std::string text;
  for (const Note& note : notes)
    text += (note.line.rfind(kComment, 0) == 0 ? note.line.substr(kComment.size()) : note.line) + '\n';
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t part = part_for_record(rest, kMost);
    append_record(head, kSpecification, kTextRecord, rest.substr(0, part));
    rest.remove_prefix(part);
  }
}

}  // namespace
}  // namespace las

bool is_las_field(const Field& field) {
  return field.is_plain() && !field.name.empty() && field.name.size() <= las::kLongestName;
}

Cloud las_of_plain(const Cloud& cloud, const std::vector<double>& coordinates, const Context& context) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  std::vector<std::size_t> finite;
  std::vector<double> xyz;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double* p = &coordinates[3 * i];
    if (!finite_row(p)) continue;
    finite.push_back(i);
    xyz.insert(xyz.end(), p, p + 3);
  }
  Cloud plain = cloud;
  select_points(plain, finite, context);
  const Sorted sorted = sort_fields(plain, context);
  Table points;
  points.name = "vertex";
  points.count = plain.size();
  points.fields = new_fields(plain.points().fields, sorted);
  choose_scale(points.fields, xyz);
  fill_rows(points, plain.points(), xyz, sorted, context);
  Cloud out;
  out.format = Format::las;
  out.xyz = {0, 1, 2};
  out.width = points.count;
  out.original_header = new_header(sorted.point_format());
  append_texts(out.original_header, plain.notes);
  out.elements.push_back(std::move(points));
  return out;
}

}  // namespace rfsmooth::pipeline::io
