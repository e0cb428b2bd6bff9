#include "pipeline/io/formats/las/las_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <rfsmooth/result.h>

#include "base/fail.h"

namespace rfsmooth::pipeline::io::las {
namespace {

// A description of extra bytes (LAS 1.4 R15, table 24): 192 bytes each.
constexpr std::size_t kDescription = 192, kTypeAt = 2, kOptionsAt = 3, kNameAt = 4, kItsScaleAt = 112,
                      kItsOffsetAt = 136;
constexpr std::uint8_t kHasScale = 8, kHasOffset = 16;
constexpr std::size_t kMostUnnamed = 255;  // bytes that one description without a type can stand for
constexpr std::size_t kLargest16 = std::numeric_limits<std::uint16_t>::max();

// Data type k + 1; 11 to 20 and 21 to 30 are two and three of them.
constexpr Scalar kExtraTypes[] = {Scalar::uint8,   Scalar::int8,   Scalar::uint16, Scalar::int16,
                                  Scalar::uint32,  Scalar::int32,  Scalar::uint64, Scalar::int64,
                                  Scalar::float32, Scalar::float64};

// The fields that one description stands for.
std::vector<Field> fields_of_description(std::string_view d) {
  const auto type = number<std::uint8_t>(d, kTypeAt), options = number<std::uint8_t>(d, kOptionsAt);
  std::string name(d.substr(kNameAt, kLongestName));
  name.resize(std::min(name.find('\0'), name.size()));
  if (name.empty()) name = "extra_bytes";
  if (type == 0) return {Field{name, Scalar::uint8, options}};
  const std::size_t n = std::size_t(type - 1) / 10 + 1;
  std::vector<Field> out;
  for (std::size_t k = 0; k < n; ++k) {
    Field field{n == 1 ? name : fmt::format("{}[{}]", name, k), kExtraTypes[(type - 1) % 10]};
    const double scale = number<double>(d, kItsScaleAt + 8 * k),
                 offset = number<double>(d, kItsOffsetAt + 8 * k);
    if ((options & kHasScale) != 0 && std::isfinite(scale) && scale != 0) field.scale = scale;
    if ((options & kHasOffset) != 0 && std::isfinite(offset)) field.offset = offset;
    out.push_back(std::move(field));
  }
  return out;
}

// Fields that the descriptions of a record stand for; none if they cannot be.
std::vector<Field> described_fields(std::string_view body, std::size_t room, bool& fits) {
  std::vector<Field> out;
  std::size_t size = 0;
  fits = body.size() % kDescription == 0;
  for (std::size_t at = 0; fits && at < body.size(); at += kDescription) {
    const std::string_view d = body.substr(at, kDescription);
    const auto type = number<std::uint8_t>(d, kTypeAt);
    fits = type <= 30 && (type != 0 || number<std::uint8_t>(d, kOptionsAt) != 0);
    if (!fits) break;
    for (Field& field : fields_of_description(d)) {
      size += field.bytes();
      out.push_back(std::move(field));
    }
    fits = size <= room;
  }
  if (!fits) out.clear();
  return out;
}

const Record* find_record(const std::vector<Record>& records, std::string_view user, std::uint16_t id) {
  for (const Record& r : records)
    if (r.is(user, id)) return &r;
  return nullptr;
}

std::string description(std::string_view name, std::uint8_t type, std::uint8_t options) {
  std::string d(kDescription, '\0');
  d[kTypeAt] = char(type);
  d[kOptionsAt] = char(options);
  name.copy(d.data() + kNameAt, kLongestName);
  return d;
}

void insert_bytes(std::string& head, std::size_t at, std::string_view bytes) {
  head.insert(at, bytes);
  put_number(head, kPointsAt, std::uint32_t(head.size()));
}

}  // namespace

bool is_extended(int point_format) {
  return point_format >= 6;
}

bool has_waveforms(int point_format) {
  return point_format == 4 || point_format == 5 || point_format >= 9;
}

std::vector<Field> standard_fields(int point_format) {
  const int f = point_format;
  std::vector<Field> fields = {{"x", Scalar::int32},
                               {"y", Scalar::int32},
                               {"z", Scalar::int32},
                               {"intensity", Scalar::uint16},
                               {"bit_fields", Scalar::uint8}};
  const auto add = [&](std::initializer_list<Field> more) { fields.insert(fields.end(), more); };
  if (is_extended(f)) {
    add({{"classification_flags", Scalar::uint8},
         {"classification", Scalar::uint8},
         {"user_data", Scalar::uint8},
         {"scan_angle", Scalar::int16},
         {"point_source_id", Scalar::uint16}});
    fields[fields.size() - 2].scale = 0.006;
  } else {
    add({{"raw_classification", Scalar::uint8},
         {"scan_angle_rank", Scalar::int8},
         {"user_data", Scalar::uint8},
         {"point_source_id", Scalar::uint16}});
  }
  if (f != 0 && f != 2) add({{"gps_time", Scalar::float64}});
  if (f == 2 || f == 3 || f == 5 || f == 7 || f == 8 || f == 10)
    add({{"red", Scalar::uint16}, {"green", Scalar::uint16}, {"blue", Scalar::uint16}});
  if (f == 8 || f == 10) add({{"nir", Scalar::uint16}});
  if (has_waveforms(f))
    add({{"wavepacket_index", Scalar::uint8},
         {"wavepacket_offset", Scalar::uint64},
         {"wavepacket_size", Scalar::uint32},
         {"return_point_wave_location", Scalar::float32},
         {"x_t", Scalar::float32},
         {"y_t", Scalar::float32},
         {"z_t", Scalar::float32}});
  return fields;
}

std::size_t row_size(int point_format) {
  std::size_t size = 0;
  for (const Field& field : standard_fields(point_format)) size += field.bytes();
  return size;
}

std::vector<Field> fields_of(std::string_view head, bool& described) {
  const Header h = read_header(head);
  std::vector<Field> fields = standard_fields(h.point_format);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    fields[axis].scale = h.scale[axis];
    fields[axis].offset = h.offset[axis];
  }
  std::size_t room = h.row_size - row_size(h.point_format);
  described = true;
  const std::vector<Record> records = records_of(head);
  if (const Record* r = find_record(records, kSpecification, kExtraBytesRecord)) {
    for (Field& field : described_fields(head.substr(r->body(), r->size), room, described)) {
      room -= field.bytes();
      fields.push_back(std::move(field));
    }
  }
  if (room > 0) fields.push_back({"extra_bytes", Scalar::uint8, room});
  return fields;
}

void append_record(std::string& head, std::string_view user, std::uint16_t id, std::string_view body) {
  const Header h = read_header(head);
  const std::vector<Record> records = records_of(head);
  std::string record(kRecordHeader, '\0');
  if (h.minor == 0) put_number<std::uint16_t>(record, 0, 0xaabb);  // LAS 1.0 marks each with this
  user.copy(record.data() + 2, 16);
  put_number(record, 18, id);
  put_number(record, 20, std::uint16_t(body.size()));
  record += body;
  put_number(head, kRecordsAt, std::uint32_t(h.records + 1));
  insert_bytes(head, records.empty() ? h.size : records.back().end(), record);
}

void describe_extra_bytes(std::string& head, const std::vector<Field>& fields) {
  const Header h = read_header(head);
  const std::vector<Record> records = records_of(head);
  const Record* record = find_record(records, kSpecification, kExtraBytesRecord);
  std::size_t undescribed = h.row_size - row_size(h.point_format);
  if (record != nullptr) {
    bool fits = true;
    const std::string_view body = std::string_view(head).substr(record->body(), record->size);
    for (const Field& field : described_fields(body, undescribed, fits)) undescribed -= field.bytes();
    if (!fits)
      fail(ErrorCode::usage,
           "LAS: the description of the extra bytes does not fit the points, so no field can be added; write "
           "another format");
  }
  std::string more;
  for (std::size_t left = undescribed; left > 0; left -= std::min(left, kMostUnnamed))
    more += description("extra_bytes", 0, std::uint8_t(std::min(left, kMostUnnamed)));
  std::size_t row = h.row_size;
  for (const Field& field : fields) {
    const auto* type = std::find(std::begin(kExtraTypes), std::end(kExtraTypes), field.type);
    more += description(field.name, std::uint8_t(type - kExtraTypes + 1), 0);
    row += field.bytes();
  }
  const std::size_t size = (record != nullptr ? record->size : 0) + more.size();
  if (size > kLargest16 || row > kLargest16)
    fail(ErrorCode::usage, "LAS has no room for so many fields; write another format");
  put_number(head, kRowSizeAt, std::uint16_t(row));
  if (record == nullptr) return append_record(head, kSpecification, kExtraBytesRecord, more);
  put_number(head, record->at + 20, std::uint16_t(size));
  insert_bytes(head, record->end(), more);
}

}  // namespace rfsmooth::pipeline::io::las
