/// Walking and rebuilding the rows of a table: shared by the files that change tables.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "pipeline/io/table/table.h"

namespace rfsmooth::pipeline::io {

/// Rows in a block of parallel work.
inline constexpr std::size_t kRowsPerBlock = 8192;

/// The count, of type `type`, stored at p.
inline std::size_t list_size(Scalar type, const char* p) {
  return std::size_t(load(type, p));
}

/// Finds where a field starts in a binary row; behind a list the offset differs from row to row.
struct Locator {
  explicit Locator(const Table& table) : fields(table.fields), fixed(!table.has_lists()) {
    std::size_t offset = 0;
    for (const Field& f : fields) {
      offsets.push_back(offset);
      if (fixed) offset += f.bytes();
    }
  }
  const char* operator()(const char* row, std::size_t field) const {
    if (fixed) return row + offsets[field];
    for (std::size_t f = 0; f < field; ++f) row += bytes_of(fields[f], row);
    return row;
  }
  static std::size_t bytes_of(const Field& f, const char* p) {
    if (!f.is_list()) return f.bytes();
    return size_of(*f.list_count) + list_size(*f.list_count, p) * size_of(f.type);
  }
  const std::vector<Field>& fields;
  bool fixed;
  std::vector<std::size_t> offsets;
};

/// Calls body(field, words) for each field of a text row; the words of a list start with its count.
template <class Body>
void for_each_field(const Table& table, std::string_view row, Body&& body) {
  std::vector<std::string_view> words;
  for (std::size_t f = 0; f < table.fields.size(); ++f) {
    words.clear();
    const Field& field = table.fields[f];
    std::size_t n = field.count;
    if (field.is_list()) {
      words.push_back(next_word(row, table.separators));
      n = std::size_t(parse_integer(words.back(), *field.list_count).value());
    }
    for (std::size_t k = 0; k < n; ++k) words.push_back(next_word(row, table.separators));
    body(f, words);
  }
}

/// Builds new rows block by block in parallel: make(i, out) appends row i.
template <class Make>
void rebuild(Table& table, const Context& context, Make&& make) {
  const std::size_t blocks = (table.count + kRowsPerBlock - 1) / kRowsPerBlock;
  std::vector<std::string> part(blocks);
  std::vector<std::uint64_t> ends(table.count + 1, 0);
  for_blocks(context, table.count, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    std::string& out = part[begin / kRowsPerBlock];
    for (std::size_t i = begin; i < end; ++i) {
      make(i, out);
      ends[i + 1] = out.size();
    }
  });
  std::vector<std::uint64_t> base(blocks + 1, 0);
  for (std::size_t b = 0; b < blocks; ++b) base[b + 1] = base[b] + part[b].size();
  Bytes data(base[blocks]);
  for_blocks(context, table.count, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    const std::size_t b = begin / kRowsPerBlock;
    std::memcpy(data.data() + base[b], part[b].data(), part[b].size());
    for (std::size_t i = begin; i < end; ++i) ends[i + 1] += base[b];
  });
  table.data = std::move(data);
  table.start = std::move(ends);
}

}  // namespace rfsmooth::pipeline::io
