#include "pipeline/io/formats/las/las_plain.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "base/parallel.h"
#include "pipeline/io/formats/las/las.h"
#include "pipeline/io/formats/las/las_fields.h"
#include "pipeline/io/formats/las/las_parts.h"

namespace rfsmooth::pipeline::io {
namespace las {
namespace {

// A plain field and where its values come from in a row.
struct Origin {
  Field field;
  const Field* stored;
  std::size_t at;
  int shift = 0, bits = 0;   // of a byte, if bits > 0
  std::uint16_t divide = 1;  // colours of 16 bits that are 8 bits times this
};

// The fields of `table`, each in its parts. Waveforms stay behind.
std::vector<Origin> origins_of(const Table& table, int point_format) {
  const std::size_t standard = standard_fields(point_format).size();
  const std::size_t waveforms = has_waveforms(point_format) ? 7 : 0;
  const auto* first = is_extended(point_format) ? std::begin(kNewParts) : std::begin(kOldParts);
  const auto* last = is_extended(point_format) ? std::end(kNewParts) : std::end(kOldParts);
  std::vector<Origin> out;
  std::size_t at = 0;
  for (std::size_t f = 0; f < table.fields.size(); ++f) {
    const Field& field = table.fields[f];
    bool split = false;
    for (const Part* part = first; f < standard && part != last; ++part) {
      if (part->of != field.name) continue;
      out.push_back({Field{std::string(part->name), Scalar::uint8}, &field, at, part->shift, part->bits});
      split = true;
    }
    const bool is_waveform = f < standard && f >= standard - waveforms;
    if (!split && !is_waveform) {
      Field plain{one_word(field.name), field.is_scaled() || f < 3 ? Scalar::float64 : field.type,
                  field.count};
      out.push_back({std::move(plain), &field, at});
    }
    at += field.bytes();
  }
  return out;
}

// 1 if the colours are 8 bits as they are, 256 or 257 if they are 8 bits times that, 0 if they are 16 bits.
std::uint16_t eight_bits(const Table& table, const std::vector<Origin>& origins, const Context& context) {
  std::uint16_t largest = 0;
  bool times_256 = true, times_257 = true;
  for (const Origin& o : origins) {
    if (!is_colour(o.field.name) || o.stored->type != Scalar::uint16) continue;
    context.check_stop();
    for (std::size_t i = 0; i < table.count; ++i) {
      const auto value = number<std::uint16_t>(table.row(i), o.at);
      largest = std::max(largest, value);
      times_256 = times_256 && value % 256 == 0;
      times_257 = times_257 && value % 257 == 0;
    }
  }
  return largest <= 255 ? 1 : times_256 ? 256 : times_257 ? 257 : 0;
}

void put_plain(const Origin& o, const char* row, char* out) {
  const char* p = row + o.at;
  if (o.bits > 0) {
    *out = char((std::uint8_t(*p) >> o.shift) & ((1 << o.bits) - 1));
  } else if (o.field.type != o.stored->type || o.stored->is_scaled()) {
    store(o.field.type, out, load(*o.stored, p) / o.divide);
  } else {
    std::memcpy(out, p, o.field.bytes());
  }
}

int point_format_of(const Cloud& las) {
  return read_header(las.original_header).point_format;
}

bool is_text(const Record& r) {
  return r.is(kSpecification, kTextRecord) && !r.extended;
}

}  // namespace
}  // namespace las

std::vector<Field> plain_fields(const Cloud& las) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  std::vector<Field> fields;
  for (Origin& o : origins_of(las.points(), point_format_of(las))) fields.push_back(std::move(o.field));
  return fields;
}

std::vector<std::string> las_losses(const Cloud& las) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  std::vector<std::string> lost;
  const LasSummary summary = las_summary(las);
  bool system = false;
  for (const Record& r : summary.records) {
    if (r.is(kSpecification, kExtraBytesRecord) || is_text(r)) continue;
    if (r.user == kProjection && system) continue;
    system = system || r.user == kProjection;
    lost.push_back(r.user == kProjection ? "the coordinate system"
                                         : fmt::format("record '{}' {}", r.user, r.id));
  }
  if (has_waveforms(summary.point_format)) lost.emplace_back("the waveforms");
  return lost;
}

Cloud plain_of_las(const Cloud& las, const Context& context) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  const Table& from = las.points();
  std::vector<Origin> origins = origins_of(from, point_format_of(las));
  const std::uint16_t divide = eight_bits(from, origins, context);
  Cloud out;
  out.xyz = {0, 1, 2};
  out.width = from.count;
  Table points;
  points.name = "vertex";
  points.count = from.count;
  for (Origin& o : origins) {
    if (divide > 0 && is_colour(o.field.name) && o.stored->type == Scalar::uint16) {
      o.field.type = Scalar::uint8;
      o.divide = divide;
    }
    points.fields.push_back(o.field);
  }
  const std::size_t size = points.row_size();
  points.data.resize(size * points.count);
  for_each_index(context, points.count, [&](std::size_t i) {
    char* to = points.data.data() + i * size;
    for (const Origin& o : origins) {
      put_plain(o, from.row(i).data(), to);
      to += o.field.bytes();
    }
  });
  out.elements.push_back(std::move(points));
  for (const Record& r : records_of(las.original_header)) {
    if (!is_text(r)) continue;
    std::string text = las.original_header.substr(r.body(), r.size);
    text.resize(std::min(text.find('\0'), text.size()));
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
      const std::string line = text.substr(at, end - at);
      const bool info = line.rfind("obj_info ", 0) == 0;
      if (!line.empty()) out.notes.push_back({info ? line : "comment " + line});
      at = end + 1;
    }
  }
  return out;
}

}  // namespace rfsmooth::pipeline::io
