#include <algorithm>
#include <optional>

#include "pipeline/io/table/table.h"
#include "pipeline/io/table/table_walk.h"

namespace rfsmooth::pipeline::io {
namespace {

/// Calls body(field, stored) for each value of the fields `which`, in the order of the row: its bytes, or its
/// text.
template <class Body>
void for_each_value(const Table& table, std::string_view row, const std::vector<std::size_t>& which,
                    const Locator& locate, Body&& body) {
  if (table.text) {
    for_each_field(table, row, [&](std::size_t f, const std::vector<std::string_view>& words) {
      if (std::find(which.begin(), which.end(), f) == which.end()) return;
      for (std::size_t k = table.fields[f].is_list() ? 1 : 0; k < words.size(); ++k)
        body(table.fields[f], words[k]);
    });
    return;
  }
  for (const std::size_t f : which) {
    const Field& field = table.fields[f];
    const std::size_t size = size_of(field.type);
    const char* p = locate(row.data(), f);
    const char* const end = p + Locator::bytes_of(field, p);
    if (field.is_list()) p += size_of(*field.list_count);
    for (; p != end; p += size) body(field, std::string_view(p, size));
  }
}

/// The new number of what is stored, if it has one and the field has room for it. What is below 0 names no
/// point and stays.
std::optional<double> new_number(const Table& table, const Field& field, std::string_view stored,
                                 const std::vector<Index>& number) {
  const double value = table.text ? value_of(stored) : load(field.type, stored.data());
  if (value < 0) return value;
  if (!(value < double(number.size())) || number[std::size_t(value)] == kNone) return std::nullopt;
  const double wanted = number[std::size_t(value)];
  char room[8];
  store(field.type, room, wanted);
  return load(field.type, room) == wanted ? std::optional(wanted) : std::nullopt;
}

}  // namespace

std::vector<std::size_t> fields_of_indices(const Table& table) {
  std::vector<std::size_t> found;
  for (std::size_t f = 0; f < table.fields.size(); ++f)
    for (const char* name : {"vertex_indices", "vertex_index", "vertex1", "vertex2"})
      if (table.fields[f].name == name) found.push_back(f);
  return found;
}

void renumber(Table& table, const std::vector<std::size_t>& which, const std::vector<Index>& number,
              const Context& context) {
  const Table& old = table;
  const bool fixed = table.start.empty();
  const Locator locate(table);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < table.count; ++i) {
    bool all = true;
    for_each_value(table, table.row(i), which, locate, [&](const Field& field, std::string_view stored) {
      all = all && new_number(old, field, stored, number).has_value();
    });
    if (all) rows.push_back(i);
  }
  select(table, rows);
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const std::string_view row = old.row(i);
    const char* copied = row.data();
    for_each_value(old, row, which, locate, [&](const Field& field, std::string_view stored) {
      out.append(copied, stored.data());
      const double wanted = new_number(old, field, stored, number).value();
      char bytes[8];
      store(field.type, bytes, wanted);
      if (!old.text)
        out.append(bytes, stored.size());
      else if (value_of(stored) == wanted)
        out.append(stored);
      else
        append_number(out, wanted, field.type);
      copied = stored.data() + stored.size();
    });
    out.append(copied, row.data() + row.size());
  });
  if (fixed) table.start.clear();
}

}  // namespace rfsmooth::pipeline::io
