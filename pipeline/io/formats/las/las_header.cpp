#include "pipeline/io/formats/las/las_header.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "pipeline/io/formats/las/las_fields.h"
#include "pipeline/io/other_formats.h"

namespace rfsmooth::pipeline::io::las {
namespace {

constexpr const char *kCut = "the file is cut short: copy or download it again",
                     *kDamaged = "the header is damaged: have the program that made the file write it again";
constexpr int kNewest = 4;
constexpr std::uint16_t kInternalWaveforms = 2;  // bit of the global encoding

// "NAME: byte N: what; advice", put together as in base/fail.h.
template <std::size_t kSize, class... Arguments>
[[noreturn]] void refuse(const Source& source, std::uint64_t at, const char* advice,
                         const char (&what)[kSize], const Arguments&... arguments) {
  source.fail("byte {}: {}; {}", at, fmt::format(fmt::runtime(what), arguments...), advice);
}

std::string text(std::string_view bytes, std::size_t at, std::size_t most) {
  const std::string_view field = bytes.substr(at, most);
  return std::string(field.substr(0, std::min(field.find('\0'), field.size())));
}

// Version, sizes and kind of points.
void check_kind(const Source& source, const Header& h, std::string_view bytes) {
  const int major = number<std::uint8_t>(bytes, kMajorAt);
  if (major != 1 || h.minor > kNewest)
    refuse(source, kMajorAt, "convert it to LAS 1.4", "expected LAS 1.0 to 1.{}, found version {}.{}",
           kNewest, major, h.minor);
  if (h.compressed)
    source.fail("byte {}: LAZ is not read; {}", kPointFormatAt, other_format_of_extension("any.laz")->advice);
  if (h.point_format > kNewestPoints)
    refuse(source, kPointFormatAt, "convert it to one of those",
           "expected a point format from 0 to {}, found {}", kNewestPoints, h.point_format);
  if (h.size < header_size(h.minor))
    refuse(source, kHeaderSizeAt, kDamaged, "expected a header of at least {} bytes for LAS 1.{}, found {}",
           header_size(h.minor), h.minor, h.size);
  if (h.points < h.size)
    refuse(source, kPointsAt, kDamaged,
           "expected the points behind the header of {} bytes, found them at byte {}", h.size, h.points);
  if (h.row_size < row_size(h.point_format))
    refuse(source, kRowSizeAt, kDamaged, "expected at least {} bytes a point for point format {}, found {}",
           row_size(h.point_format), h.point_format, h.row_size);
}

void check_numbers(const Source& source, const Header& h) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (h.scale[axis] == 0 || !std::isfinite(h.scale[axis]))
      refuse(source, kScaleAt + 8 * axis, kDamaged, "expected a scale of {} other than 0, found {}",
             char('x' + char(axis)), h.scale[axis]);
    if (!std::isfinite(h.offset[axis]))
      refuse(source, kOffsetAt + 8 * axis, kDamaged, "expected an offset of {}, found {}",
             char('x' + char(axis)), h.offset[axis]);
  }
  const std::uint64_t left = source.size() - std::min(source.size(), h.points);
  if (h.points > source.size() || h.count > left / h.row_size)
    refuse(source, h.points, kCut, "expected {} of {} bytes each, found {}", counted(h.count, "point"),
           h.row_size, counted(left, "byte"));
}

// LAS 1.3 has the waveforms in an extended record that its header gives the place of; 1.4 counts it with the
// others.
void check_waveforms(const Source& source, const Header& h, std::string_view tail) {
  if (!has_waveforms(h.point_format) || !h.waveforms_inside || h.waveforms == 0) return;
  const std::uint64_t end = h.end_of_points();
  const bool begins = h.waveforms >= end && tail.size() >= kExtendedHeader &&
                      h.waveforms - end <= tail.size() - kExtendedHeader;
  const std::size_t at = begins ? std::size_t(h.waveforms - end) : 0;
  if (!begins || number<std::uint64_t>(tail, at + 20) > tail.size() - at - kExtendedHeader)
    refuse(source, kWaveformsAt, kCut,
           "expected the waveforms from byte {} on, found the points to end at byte {} and the file at "
           "byte {}",
           h.waveforms, end, source.size());
}

}  // namespace

std::size_t header_size(int minor) {
  return minor < 3 ? kWaveformsAt : minor < 4 ? kExtendedAt : 375;
}

Header read_header(std::string_view bytes) {
  Header h;
  h.minor = number<std::uint8_t>(bytes, kMinorAt);
  const auto format = number<std::uint8_t>(bytes, kPointFormatAt);
  h.point_format = format & 0x3f;
  h.compressed = (format & 0xc0) != 0;
  h.size = number<std::uint16_t>(bytes, kHeaderSizeAt);
  h.points = number<std::uint32_t>(bytes, kPointsAt);
  h.records = number<std::uint32_t>(bytes, kRecordsAt);
  h.row_size = number<std::uint16_t>(bytes, kRowSizeAt);
  h.legacy_count = h.count = number<std::uint32_t>(bytes, kLegacyCountAt);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    h.scale[axis] = number<double>(bytes, kScaleAt + 8 * axis);
    h.offset[axis] = number<double>(bytes, kOffsetAt + 8 * axis);
  }
  h.waveforms_inside = h.minor >= 3 && (number<std::uint16_t>(bytes, kEncodingAt) & kInternalWaveforms) != 0;
  if (h.minor >= 3) h.waveforms = number<std::uint64_t>(bytes, kWaveformsAt);
  if (h.minor < 4) return h;
  h.extended = number<std::uint64_t>(bytes, kExtendedAt);
  h.extended_count = number<std::uint32_t>(bytes, kExtendedCountAt);
  // Some writers of 1.4 fill in the old count only.
  if (const auto count = number<std::uint64_t>(bytes, kCountAt); count != 0) h.count = count;
  return h;
}

Header read_header(const Source& source, const Context& context) {
  const auto need = [&](std::size_t size, const std::string& what) {
    if (source.size() < size)
      refuse(source, source.size(), kCut, "expected {} of {} bytes, found {}", what, size, source.size());
  };
  need(kWaveformsAt, "a LAS header");
  const Bytes first = source.read(0, kWaveformsAt, context);
  const std::string_view start(first.data(), first.size());
  if (start.substr(0, 4) != "LASF") source.fail("byte 0: expected a LAS file, which begins with LASF");
  // The version says how long the header is; of an unknown one, no more than this is read.
  const int minor = number<std::uint8_t>(start, kMinorAt);
  const std::size_t size = minor > kNewest ? kWaveformsAt : header_size(minor);
  need(size, fmt::format("the header of LAS 1.{}", minor));
  Bytes all = source.read(0, size, context);
  all.resize(header_size(kNewest), '\0');
  const std::string_view bytes(all.data(), all.size());
  const Header h = read_header(bytes);
  check_kind(source, h, bytes);
  check_numbers(source, h);
  if (h.minor == kNewest && h.legacy_count != 0 && h.legacy_count != h.count)
    context.warn(fmt::format("{}: the header says {} and, for old readers, {}; the first is taken",
                             source.name(), counted(h.count, "point"), h.legacy_count));
  return h;
}

std::vector<Record> records_of(std::string_view head) {
  const Header h = read_header(head);
  std::vector<Record> out;
  std::size_t at = h.size;
  for (std::uint64_t k = 0; k < h.records && head.size() - at >= kRecordHeader; ++k) {
    Record r{at, number<std::uint16_t>(head, at + 20), false, text(head, at + 2, 16),
             number<std::uint16_t>(head, at + 18)};
    if (r.end() > head.size()) break;
    at = r.end();
    out.push_back(std::move(r));
  }
  return out;
}

std::vector<Record> extended_records_of(const Header& header, std::string_view tail, std::uint64_t from) {
  std::vector<Record> out;
  if (header.extended < from || header.extended - from > tail.size()) return out;
  std::size_t at = std::size_t(header.extended - from);
  for (std::uint64_t k = 0; k < header.extended_count && tail.size() - at >= kExtendedHeader; ++k) {
    const auto size = number<std::uint64_t>(tail, at + 20);
    if (size > tail.size() - at - kExtendedHeader) break;
    out.push_back(
        {at, std::size_t(size), true, text(tail, at + 2, 16), number<std::uint16_t>(tail, at + 18)});
    at = out.back().end();
  }
  return out;
}

void check_records(const Source& source, std::string_view head) {
  const Header h = read_header(head);
  const std::vector<Record> records = records_of(head);
  if (records.size() == h.records) return;
  const std::size_t at = records.empty() ? h.size : records.back().end();
  refuse(source, at, kDamaged,
         "expected variable length record {} of {} to end before the points at byte {}, found it longer",
         records.size() + 1, h.records, h.points);
}

void check_extended(const Source& source, const Header& h, std::string_view tail) {
  const std::uint64_t end = h.end_of_points();
  if (h.extended_count > 0 && h.extended < end)
    refuse(source, kExtendedAt, kDamaged,
           "expected the extended records behind the points, which end at byte {}, found byte {}", end,
           h.extended);
  const std::vector<Record> records = extended_records_of(h, tail, end);
  if (records.size() < h.extended_count)
    refuse(source, records.empty() ? h.extended : end + records.back().end(), kCut,
           "expected extended record {} of {}, found the end of the file at byte {}", records.size() + 1,
           h.extended_count, source.size());
  check_waveforms(source, h, tail);
}

}  // namespace rfsmooth::pipeline::io::las
