#include <algorithm>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::size_t kBinaryRowsPerBlock = 8192;

void swap_values(char* p, std::size_t size, std::size_t n) {
  if (size == 1) return;
  for (std::size_t k = 0; k < n; ++k) std::reverse(p + k * size, p + (k + 1) * size);
}

// Reverses the bytes of every value in rows of fixed size.
void swap_fixed(const std::vector<Field>& fields, std::size_t row_size, char* data, std::size_t count,
                const Context& context) {
  for_blocks(context, count, kBinaryRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      char* p = data + i * row_size;
      for (const Field& f : fields) {
        swap_values(p, size_of(f.type), f.count);
        p += f.bytes();
      }
    }
  });
}

void read_fixed(Table& table, BinaryCursor& cursor, const Context& context) {
  const std::uint64_t end = end_of_rows(table, cursor.offset, cursor.source);
  table.data = cursor.source.read(cursor.offset, std::size_t(end - cursor.offset), context);
  if (cursor.big_endian) swap_fixed(table.fields, table.row_size(), table.data.data(), table.count, context);
  cursor.offset = end;
}

// Rows with lists have no size one could know beforehand: walk them.
void read_lists(Table& table, BinaryCursor& cursor, const Context& context) {
  if (cursor.held.empty()) {
    cursor.held_from = cursor.offset;
    cursor.held =
        cursor.source.read(cursor.offset, std::size_t(cursor.source.size() - cursor.offset), context);
  }
  char* const first = cursor.held.data() + (cursor.offset - cursor.held_from);
  char* const end = cursor.held.data() + cursor.held.size();
  char* p = first;

  // Each row needs at least its lists' counts and its plain values.
  std::size_t least = 0;
  for (const Field& f : table.fields) least += f.is_list() ? size_of(*f.list_count) : f.bytes();
  if (least > 0 && table.count > std::size_t(end - p) / least)
    cursor.source.fail("byte {}: expected {} of element '{}', at least {} each, found {}", cursor.offset,
                       counted(table.count, "row"), table.name, counted(least, "byte"),
                       counted(std::uint64_t(end - p), "byte"));

  const auto short_of = [&](std::size_t row, const Field& f, std::size_t need) {
    cursor.source.fail("byte {}: expected {} of '{}' in row {} of element '{}', found {}",
                       cursor.held_from + std::uint64_t(p - cursor.held.data()), counted(need, "byte"),
                       f.name, row, table.name, end - p);
  };
  table.start.resize(table.count + 1);
  table.start[0] = 0;
  for (std::size_t i = 0; i < table.count; ++i) {
    if (i % kBinaryRowsPerBlock == 0) context.check_stop();
    for (const Field& f : table.fields) {
      std::size_t n = f.count;
      if (f.is_list()) {
        const std::size_t size = size_of(*f.list_count);
        if (std::size_t(end - p) < size) short_of(i, f, size);
        if (cursor.big_endian) swap_values(p, size, 1);
        const double length = load(*f.list_count, p);
        if (!(length >= 0) || length > double(std::uint64_t{1} << 40))
          cursor.source.fail("byte {}: expected the length of list '{}' in row {} of element '{}', found {}",
                             cursor.held_from + std::uint64_t(p - cursor.held.data()), f.name, i, table.name,
                             length);
        n = std::size_t(length);
        p += size;
      }
      const std::size_t size = size_of(f.type);
      if (std::size_t(end - p) / size < n) short_of(i, f, n * size);
      if (cursor.big_endian) swap_values(p, size, n);
      p += n * size;
    }
    table.start[i + 1] = std::uint64_t(p - first);
  }
  const auto size = std::size_t(p - first);
  std::size_t next = std::size_t(p - cursor.held.data());
  table.data = take_bytes(cursor.held, next - size, size, next);
  cursor.offset += size;
  cursor.held_from = cursor.offset - next;
}

void swap_lists(Table& table) {
  char* p = table.data.data();
  for (std::size_t i = 0; i < table.count; ++i)
    for (const Field& f : table.fields) {
      std::size_t n = f.count;
      if (f.is_list()) {
        n = std::size_t(load(*f.list_count, p));
        swap_values(p, size_of(*f.list_count), 1);
        p += size_of(*f.list_count);
      }
      swap_values(p, size_of(f.type), n);
      p += n * size_of(f.type);
    }
}

}  // namespace

std::uint64_t end_of_rows(const Table& table, std::uint64_t offset, const Source& source) {
  if (table.count == 0) return offset;
  const std::size_t size = table.row_size();
  const std::uint64_t left = source.size() - std::min(source.size(), offset);
  if (size == 0 || table.count > left / size)
    source.fail("byte {}: expected {} of element '{}', {} each, found {}", offset,
                counted(table.count, "row"), table.name, counted(size, "byte"), counted(left, "byte"));
  return offset + table.count * size;
}

void read_binary_rows(Table& table, BinaryCursor& cursor, const Context& context) {
  if (table.count == 0) return;
  if (table.has_lists())
    read_lists(table, cursor, context);
  else
    read_fixed(table, cursor, context);
}

void write_binary_rows(const Table& table, bool big_endian, Sink& sink, const Context& context) {
  if (!table.text && !big_endian) return sink.write({table.data.data(), table.data.size()});
  Table copy = table;
  make_binary(copy, context);
  if (big_endian && copy.has_lists()) swap_lists(copy);
  if (big_endian && !copy.has_lists())
    swap_fixed(copy.fields, copy.row_size(), copy.data.data(), copy.count, context);
  sink.write({copy.data.data(), copy.data.size()});
}

}  // namespace rfsmooth::pipeline::io
