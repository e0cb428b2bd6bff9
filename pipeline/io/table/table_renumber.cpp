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

/// Whether what has this index has a new number.
bool has_number(double value, const std::vector<Index>& number) {
  return value < double(number.size()) && number[std::size_t(value)] != kNone;
}

/// Whether values of that type can be this one.
bool can_say(Scalar type, double value) {
  char room[8];
  store(type, room, value);
  return load(type, room) == value;
}

/// The new number of what is stored, if it has one and the field has room for it. What is below 0 names no
/// point and stays.
std::optional<double> new_number(const Table& table, const Field& field, std::string_view stored,
                                 const std::vector<Index>& number) {
  const double value = table.text ? value_of(stored) : load(field.type, stored.data());
  if (value < 0) return value;
  if (!has_number(value, number)) return std::nullopt;
  const double wanted = number[std::size_t(value)];
  return can_say(field.type, wanted) ? std::optional(wanted) : std::nullopt;
}

/// What is left of strips of triangles, parted by -1, without the points that have no new number. A piece
/// that begins at an odd place of its strip gets its first point twice: every other triangle of a strip is
/// turned.
std::vector<double> cut_strips(const std::vector<double>& strips, const std::vector<Index>& number) {
  std::vector<double> left;
  std::size_t strip = 0, piece = 0;  // where they begin
  for (std::size_t k = 0; k <= strips.size(); ++k) {
    const bool ends = k == strips.size() || strips[k] < 0;
    if (!ends && has_number(strips[k], number)) continue;
    if (k - piece >= 3) {
      if (!left.empty()) left.push_back(-1);
      if ((piece - strip) % 2 != 0) left.push_back(strips[piece]);
      left.insert(left.end(), strips.begin() + std::ptrdiff_t(piece), strips.begin() + std::ptrdiff_t(k));
    }
    piece = k + 1;
    if (ends) strip = k + 1;
  }
  if (!left.empty() && strips.back() < 0) left.push_back(-1);
  return left;
}

/// Appends a row of bytes with other values in its list `field`.
void append_row_of_bytes(const Table& table, std::string_view row, std::size_t field,
                         const std::vector<double>& values, std::string& out) {
  const Field& list = table.fields[field];
  const char* const at = Locator(table)(row.data(), field);
  out.append(row.data(), at);
  char room[8];
  store(*list.list_count, room, double(values.size()));
  out.append(room, size_of(*list.list_count));
  for (const double value : values) {
    store(list.type, room, value);
    out.append(room, size_of(list.type));
  }
  out.append(at + Locator::bytes_of(list, at), row.data() + row.size());
}

/// The same of a row of text.
void append_row_of_text(const Table& table, std::string_view row, std::size_t field,
                        const std::vector<double>& values, std::string& out) {
  for_each_field(table, row, [&](std::size_t f, const std::vector<std::string_view>& words) {
    if (f != field) return;
    out.append(row.data(), words.front().data());
    out += std::to_string(values.size());
    for (const double value : values) {
      out += ' ';
      append_number(out, value, table.fields[field].type);
    }
    out.append(words.back().data() + words.back().size(), row.data() + row.size());
  });
}

/// Cuts the strips in the list `field` where a point has no new number. A row of which no triangle is left,
/// or whose types cannot say what is, stays as it is.
void cut_rows_of_strips(Table& table, std::size_t field, const std::vector<Index>& number,
                        const Context& context) {
  const Lists all = gather_lists(table, field, context);
  const Table& old = table;
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const std::vector<double> strips(all.values.begin() + std::ptrdiff_t(all.start[i]),
                                     all.values.begin() + std::ptrdiff_t(all.start[i + 1]));
    const bool whole = std::all_of(strips.begin(), strips.end(),
                                   [&](double value) { return value < 0 || has_number(value, number); });
    const std::vector<double> left = whole ? strips : cut_strips(strips, number);
    const Field& list = old.fields[field];
    const bool parted = std::find(left.begin(), left.end(), -1) != left.end();
    if (whole || left.empty() || !can_say(*list.list_count, double(left.size())) ||
        (parted && !can_say(list.type, -1)))
      out.append(old.row(i));
    else if (old.text)
      append_row_of_text(old, old.row(i), field, left, out);
    else
      append_row_of_bytes(old, old.row(i), field, left, out);
  });
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
  for (const std::size_t f : which)
    if (table.name == "tristrips" && table.fields[f].is_list()) cut_rows_of_strips(table, f, number, context);
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
