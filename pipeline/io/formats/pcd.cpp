#include "pipeline/io/formats/pcd.h"

#include <cstring>
#include <limits>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/io/formats/lzf.h"
#include "pipeline/io/formats/ply.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::size_t kColumnRowsPerBlock = 16384;

// binary_compressed holds field after field, each for all points; we hold point after point.
enum class Direction { to_rows, to_columns };

void transpose(const Table& table, Direction direction, const char* in, char* out, const Context& context) {
  const std::size_t row = table.row_size();
  for_blocks(context, table.count, kColumnRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    std::size_t offset = 0;
    for (const Field& f : table.fields) {
      const std::size_t size = f.bytes();
      const std::size_t column = offset * table.count;
      // Constant sizes let the compiler turn the copies into single moves.
      const auto copy = [&](auto constant) {
        const std::size_t n = decltype(constant)::value == 0 ? size : decltype(constant)::value;
        for (std::size_t i = begin; i < end; ++i) {
          const std::size_t in_rows = i * row + offset, in_columns = column + i * size;
          if (direction == Direction::to_rows)
            std::memcpy(out + in_rows, in + in_columns, n);
          else
            std::memcpy(out + in_columns, in + in_rows, n);
        }
      };
      switch (size) {
        case 1:
          copy(std::integral_constant<std::size_t, 1>{});
          break;
        case 2:
          copy(std::integral_constant<std::size_t, 2>{});
          break;
        case 4:
          copy(std::integral_constant<std::size_t, 4>{});
          break;
        case 8:
          copy(std::integral_constant<std::size_t, 8>{});
          break;
        default:
          copy(std::integral_constant<std::size_t, 0>{});
      }
      offset += size;
    }
  });
}

void read_compressed(Table& table, BinaryCursor& cursor, const Context& context) {
  const Source& source = cursor.source;
  const std::uint64_t at = cursor.offset, left = source.size() - at;
  if (table.count == 0) {
    // Some writers put two zero sizes here, some nothing.
    if (left >= 8 && source.read(at, 8, context) == Bytes(8, '\0')) cursor.offset += 8;
    return;
  }
  if (left < 8)
    source.fail("byte {}: expected the sizes of the compressed data (8 bytes), found {}", at,
                counted(left, "byte"));
  std::uint32_t sizes[2];
  source.read(at, reinterpret_cast<char*>(sizes), sizeof sizes, context);
  const std::uint64_t packed = sizes[0], unpacked = sizes[1];
  if (packed > left - 8)
    source.fail("byte {}: expected {} of compressed data, found {}", at + 8, counted(packed, "byte"),
                left - 8);
  const std::size_t row = table.row_size();
  if (table.count > std::numeric_limits<std::uint32_t>::max() / row || table.count * row != unpacked)
    source.fail("byte {}: expected {} of {} each when unpacked, found {}", at + 4,
                counted(table.count, "point"), counted(row, "byte"), counted(unpacked, "byte"));
  if (unpacked > packed * kLzfMostGain)
    source.fail("byte {}: expected compressed data for {}, found {}, which cannot hold as much", at,
                counted(unpacked, "byte"), counted(packed, "byte"));
  const Bytes stream = source.read(at + 8, std::size_t(packed), context);
  Bytes columns(static_cast<std::size_t>(unpacked));
  const LzfOutcome outcome = lzf_decompress({stream.data(), stream.size()}, columns.data(), columns.size());
  if (!outcome.ok)
    source.fail("byte {}: expected intact compressed data, found damage: {}", at + 8 + outcome.at,
                outcome.what);
  table.data.resize(columns.size());
  transpose(table, Direction::to_rows, columns.data(), table.data.data(), context);
  cursor.offset += 8 + packed;
}

void write_compressed(const Table& table, Sink& sink, const Context& context) {
  if (table.text) {
    Table copy = table;
    make_binary(copy, context);
    return write_compressed(copy, sink, context);
  }
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  Bytes columns(table.data.size());
  transpose(table, Direction::to_columns, table.data.data(), columns.data(), context);
  const Bytes packed = lzf_compress({columns.data(), columns.size()});
  if (packed.size() > kMost || columns.size() > kMost)
    fail(ErrorCode::usage, "binary_compressed holds at most 4 GiB; write binary instead");
  const std::uint32_t sizes[2] = {std::uint32_t(packed.size()), std::uint32_t(columns.size())};
  sink.write({reinterpret_cast<const char*>(sizes), sizeof sizes});
  sink.write({packed.data(), packed.size()});
}

}  // namespace

Cloud read_pcd(const Source& source, const Context& context) {
  HeaderLines lines(source, context);
  Cloud cloud = read_pcd_header(lines);
  find_coordinates(cloud, source, context);
  Table& table = cloud.points();
  if (cloud.encoding == Encoding::ascii) {
    TextCursor cursor(source, lines.offset(), lines.line(), context);
    read_text_rows(table, cursor, context);
    cloud.tail = cursor.rest();
  } else {
    BinaryCursor cursor{source, lines.offset()};
    if (cloud.encoding == Encoding::binary_compressed)
      read_compressed(table, cursor, context);
    else
      read_binary_rows(table, cursor, context);
    const Bytes rest = source.read(cursor.offset, std::size_t(source.size() - cursor.offset), context);
    cloud.tail.assign(rest.data(), rest.size());
  }
  warn_of_tail(cloud, source, context);
  return cloud;
}

void write_pcd(const Cloud& cloud, Encoding encoding, Sink& sink, const Context& context) {
  if (encoding == Encoding::binary_big_endian)
    fail(ErrorCode::usage, "PCD has no big-endian encoding; use ascii, binary or binary_compressed");
  sink.write(cloud.header(pcd_header(cloud, encoding)));
  if (encoding == Encoding::ascii)
    write_text_rows(cloud.points(), sink, context);
  else if (encoding == Encoding::binary_little_endian)
    write_binary_rows(cloud.points(), false, sink, context);
  else
    write_compressed(cloud.points(), sink, context);
  if (encoding == cloud.encoding) sink.write(cloud.tail);
}

}  // namespace rfsmooth::pipeline::io
