#include "pipeline/io/formats/las/las.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/io/formats/las/las_fields.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {
namespace las {
namespace {

// A header counts points in all and by return: in 32 bits for five returns; LAS 1.4 in 64 bits for fifteen,
// and may leave the old words empty.
constexpr std::size_t kLegacyReturns = 5, kReturns = 15;
constexpr std::uint64_t kMostLegacy = std::numeric_limits<std::uint32_t>::max();

// What a header says of its points, made from them.
struct Facts {
  std::array<double, 3> scale{}, offset{};
  std::array<double, 6> box{};  // largest and smallest x, y, z, as the header has them
  std::uint64_t count = 0;
  std::array<std::uint64_t, kReturns> by_return{};
};

// Of raw coordinates, in the steps of the scale.
struct Range {
  std::array<std::int32_t, 3> low, high;
  std::array<std::uint64_t, kReturns> by_return{};
};

Range joined(const Range& a, const Range& b) {
  Range r = a;
  for (std::size_t k = 0; k < 3; ++k) {
    r.low[k] = std::min(a.low[k], b.low[k]);
    r.high[k] = std::max(a.high[k], b.high[k]);
  }
  for (std::size_t k = 0; k < kReturns; ++k) r.by_return[k] += b.by_return[k];
  return r;
}

Facts facts_of(const Table& points, int point_format, const Context& context) {
  constexpr std::int32_t kLeast = std::numeric_limits<std::int32_t>::min(),
                         kMost = std::numeric_limits<std::int32_t>::max();
  constexpr std::size_t kReturnAt = 14;                         // of a point: which return it is, ...
  const int mask = is_extended(point_format) ? 0b1111 : 0b111;  // ... in its lowest bits
  const Range none{{kMost, kMost, kMost}, {kLeast, kLeast, kLeast}};
  const auto block = [&](std::size_t begin, std::size_t end) {
    Range r = none;
    for (std::size_t i = begin; i < end; ++i) {
      const std::string_view row = points.row(i);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto value = number<std::int32_t>(row, 4 * k);
        r.low[k] = std::min(r.low[k], value);
        r.high[k] = std::max(r.high[k], value);
      }
      const int nth = number<std::uint8_t>(row, kReturnAt) & mask;
      if (nth > 0) ++r.by_return[std::size_t(nth - 1)];
    }
    return r;
  };
  const Range range = reduce_blocks(context, points.count, none, block, joined, 16384);
  Facts facts;
  facts.count = points.count;
  facts.by_return = range.by_return;
  for (std::size_t k = 0; k < 3; ++k) {
    const Field& field = points.fields[k];
    facts.scale[k] = field.scale;
    facts.offset[k] = field.offset;
    if (points.count == 0) continue;
    const double a = range.low[k] * field.scale + field.offset,
                 b = range.high[k] * field.scale + field.offset;
    facts.box[2 * k] = std::max(a, b);
    facts.box[2 * k + 1] = std::min(a, b);
  }
  return facts;
}

template <class T, std::size_t n>
bool same_bytes(const std::array<T, n>& a, const std::array<T, n>& b) {
  return std::memcmp(a.data(), b.data(), sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

void put_counts(std::string& head, const Header& h, const Facts& now) {
  const bool legacy = h.minor < 4 || h.legacy_count != 0;
  if (h.minor < 4 && now.count > kMostLegacy)
    fail(ErrorCode::usage, "LAS 1.{} holds at most {} points", h.minor, kMostLegacy);
  const bool fits = now.count <= kMostLegacy;
  if (legacy) {
    put_number(head, kLegacyCountAt, std::uint32_t(fits ? now.count : 0));
    for (std::size_t k = 0; k < kLegacyReturns; ++k)
      put_number(head, kLegacyReturnsAt + 4 * k, std::uint32_t(fits ? now.by_return[k] : 0));
  }
  if (h.minor < 4) return;
  put_number(head, kCountAt, now.count);
  for (std::size_t k = 0; k < kReturns; ++k) put_number(head, kReturnsAt + 8 * k, now.by_return[k]);
}

// Changes in the header what the points no longer agree with. `before`: of the file as it was, none if it is
// new.
void put_facts(std::string& head, const std::optional<Facts>& before, const Facts& now) {
  const Header h = read_header(head);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!before || before->scale[k] != now.scale[k]) put_number(head, kScaleAt + 8 * k, now.scale[k]);
    if (!before || before->offset[k] != now.offset[k]) put_number(head, kOffsetAt + 8 * k, now.offset[k]);
  }
  if (!before || !same_bytes(before->box, now.box))
    for (std::size_t k = 0; k < 6; ++k) put_number(head, kBoxAt + 8 * k, now.box[k]);
  if (!before || before->count != now.count || !same_bytes(before->by_return, now.by_return))
    put_counts(head, h, now);
}

// What stood behind the points stands behind them still.
void put_places(std::string& head, const Header& was, std::uint64_t end_now) {
  const auto move = [&](std::size_t at, std::uint64_t place) {
    if (place != 0 && place >= was.end_of_points())
      put_number(head, at, place - was.end_of_points() + end_now);
  };
  if (was.minor >= 3) move(kWaveformsAt, was.waveforms);
  if (was.minor >= 4) move(kExtendedAt, was.extended);
}

std::vector<Field> fields_behind(const std::vector<Field>& fields, std::size_t row_size) {
  std::size_t at = 0, first = 0;
  while (first < fields.size() && at < row_size) {
    at += fields[first].bytes();
    ++first;
  }
  return {fields.begin() + std::ptrdiff_t(first), fields.end()};
}

}  // namespace
}  // namespace las

Cloud read_las(const Source& source, const Context& context) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  const Header header = read_header(source, context);
  const Bytes head = source.read(0, std::size_t(header.points), context);
  Cloud cloud;
  cloud.format = Format::las;
  cloud.original_header.assign(head.data(), head.size());
  check_records(source, cloud.original_header);
  Table points;
  points.name = "vertex";
  points.count = std::size_t(header.count);
  bool described = true;
  points.fields = fields_of(cloud.original_header, described);
  if (!described)
    context.warn(
        fmt::format("{}: the description of the extra bytes does not fit the points; they are kept without "
                    "names",
                    source.name()));
  BinaryCursor cursor{source, header.points};
  read_binary_rows(points, cursor, context);
  const Bytes tail = source.read(cursor.offset, std::size_t(source.size() - cursor.offset), context);
  cloud.tail.assign(tail.data(), tail.size());
  check_extended(source, header, cloud.tail);
  // As bytes: what tells write_las whether the header still agrees.
  const Facts facts = facts_of(points, header.point_format, context);
  cloud.original_canonical.assign(reinterpret_cast<const char*>(&facts), sizeof facts);
  cloud.xyz = {0, 1, 2};
  cloud.width = points.count;
  cloud.elements.push_back(std::move(points));
  return cloud;
}

void write_las(const Cloud& cloud, Sink& sink, const Context& context) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  const Table& points = cloud.points();
  std::string head = cloud.original_header;
  const Header was = read_header(head);
  std::optional<Facts> before;
  if (cloud.original_canonical.size() == sizeof(Facts)) {
    before.emplace();
    std::memcpy(&*before, cloud.original_canonical.data(), sizeof(Facts));
  }
  put_facts(head, before, facts_of(points, was.point_format, context));
  const std::vector<Field> added = fields_behind(points.fields, was.row_size);
  if (!added.empty()) describe_extra_bytes(head, added);
  put_places(head, was, head.size() + points.data.size());
  sink.write(head);
  write_binary_rows(points, false, sink, context);
  sink.write(cloud.tail);
}

LasSummary las_summary(const Cloud& cloud) {
  using namespace las;  // NOLINT(google-build-using-namespace)
  const Header h = read_header(cloud.original_header);
  LasSummary out{h.minor, h.point_format, {}, {}, records_of(cloud.original_header)};
  for (std::size_t k = 0; k < 3; ++k) {
    out.scale[k] = cloud.points().fields[k].scale;
    out.offset[k] = cloud.points().fields[k].offset;
  }
  const std::vector<Record> more = extended_records_of(h, cloud.tail, h.end_of_points());
  out.records.insert(out.records.end(), more.begin(), more.end());
  return out;
}

}  // namespace rfsmooth::pipeline::io
