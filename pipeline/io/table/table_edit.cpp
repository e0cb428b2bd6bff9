#include <algorithm>
#include <stdexcept>

#include "pipeline/io/table/table.h"
#include "pipeline/io/table/table_walk.h"

namespace rfsmooth::pipeline::io {
namespace {

// Behind the last value of a text row: where its trailing blanks and line end begin.
std::size_t content_size(std::string_view row, Separators separators) {
  const auto is_behind = [&](char c) {
    // A tab may belong to an empty last cell.
    return cell_separator(separators) != '\0' ? c == ' ' || c == '\r' || c == '\n'
                                              : is_separator(c, separators);
  };
  std::size_t n = row.size();
  while (n > 0 && is_behind(row[n - 1])) --n;
  return n;
}

// What to put between a row's values.
char separator_in(std::string_view row, Separators separators) {
  if (const char of_cells = cell_separator(separators); of_cells != '\0') return of_cells;
  const std::size_t comma =
      separators == Separators::space_comma ? row.find_first_of(",;") : std::string_view::npos;
  return comma == std::string_view::npos ? ' ' : row[comma];
}

// Whether a tab stands anywhere, or a CR anywhere but before an LF: in text without a header the one parts
// cells, the other lines, where here both are blanks between words.
bool has_other_blanks(const Bytes& text) {
  const auto is_other = [](char c, char next) { return c == '\t' || (c == '\r' && next != '\n'); };
  return std::adjacent_find(text.begin(), text.end(), is_other) != text.end();
}

// Writes the rows of a text anew, with words or cells.
void separate(Table& table, Separators separators, const Context& context) {
  const char cell = cell_separator(separators);
  const Table& old = table;
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    bool first = true;
    for (const std::string_view word : words_of(old.row(i), old.separators)) {
      if (!first) out += cell == '\0' ? ' ' : cell;
      first = false;
      out.append(word.empty() && cell == '\0' ? "nan" : word);
    }
    out += '\n';
  });
  table.separators = separators;
}

}  // namespace

void append_field(Table& table, const Field& field, const double* values, const Context& context) {
  if (!field.is_plain())
    throw std::invalid_argument("append_field: '" + field.name + "' is not one value per row");
  const Table& old = table;
  std::vector<Field> fields = table.fields;  // made before anything changes: memory may run out
  fields.push_back(field);
  if (table.text) {
    rebuild(table, context, [&](std::size_t i, std::string& out) {
      const std::string_view row = old.row(i);
      const std::size_t n = content_size(row, old.separators);
      const bool quoted = cell_separator(old.separators) != '\0' && n > 0 && row[n - 1] == '"';
      out.append(row.substr(0, n)) += separator_in(row, old.separators);
      if (quoted) out += '"';
      append_number(out, values[i], field.type);
      if (quoted) out += '"';
      out.append(row.substr(n));
    });
  } else {
    const bool fixed = !table.has_lists();
    rebuild(table, context, [&](std::size_t i, std::string& out) {
      out.append(old.row(i));
      char p[8];
      store(field.type, p, values[i]);
      out.append(p, size_of(field.type));
    });
    if (fixed) table.start.clear();
  }
  table.fields = std::move(fields);
}

void insert_list_counts(Table& table, std::size_t which, Scalar count_type, const Context& context) {
  const std::size_t n = table.fields.at(which).count;
  const Table& old = table;
  const Locator locate(table);
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const std::string_view row = old.row(i);
    const char* at = nullptr;
    if (old.text) {
      for_each_field(old, row, [&](std::size_t f, const std::vector<std::string_view>& words) {
        if (f == which) at = words.front().data();
      });
    } else {
      at = locate(row.data(), which);
    }
    char stored[8];
    store(count_type, stored, double(n));
    out.append(row.data(), at);
    if (old.text) {
      append_stored(out, stored, count_type);
      out += ' ';
    } else {
      out.append(stored, size_of(count_type));
    }
    out.append(at, row.data() + row.size());
  });
  table.fields[which].list_count = count_type;
  table.fields[which].count = 1;
}

void remove_list_counts(Table& table, std::size_t which, std::size_t count, const Context& context) {
  const Table& old = table;
  const Locator locate(table);
  const std::size_t size = size_of(table.fields.at(which).list_count.value());
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const std::string_view row = old.row(i);
    const char *from = nullptr, *to = nullptr;
    if (old.text) {
      for_each_field(old, row, [&](std::size_t f, const std::vector<std::string_view>& words) {
        if (f != which) return;
        from = words[0].data();
        to = words[1].data();
      });
    } else {
      from = locate(row.data(), which);
      to = from + size;
    }
    out.append(row.data(), from);
    out.append(to, row.data() + row.size());
  });
  table.fields[which].list_count.reset();
  table.fields[which].count = count;
  if (!table.text && !table.has_lists()) table.start.clear();
}

void project(Table& table, const std::vector<std::size_t>& which, const Context& context) {
  const Table& old = table;
  const Locator locate(table);
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const std::string_view row = old.row(i);
    if (!old.text) {
      for (const std::size_t f : which) {
        const char* p = locate(row.data(), f);
        out.append(p, Locator::bytes_of(old.fields[f], p));
      }
      return;
    }
    std::vector<std::string> columns(old.fields.size());
    for_each_field(old, row, [&](std::size_t f, const std::vector<std::string_view>& words) {
      for (const std::string_view word : words) columns[f].append(columns[f].empty() ? "" : " ").append(word);
    });
    bool first = true;
    for (const std::size_t f : which) {
      if (!first) out += ' ';
      first = false;
      out += columns[f];
    }
    out += '\n';
  });
  std::vector<Field> fields;
  for (const std::size_t f : which) fields.push_back(table.fields[f]);
  table.fields = std::move(fields);
  table.ragged = false;
  if (table.text) table.separators = Separators::space;
  if (!table.text && !table.has_lists()) table.start.clear();
}

void make_words(Table& table, const Context& context) {
  if (!table.text || (table.separators == Separators::space && !has_other_blanks(table.data))) return;
  separate(table, Separators::space, context);
}

void make_cells(Table& table, Separators separators, const Context& context) {
  make_text(table, context);
  separate(table, separators, context);
}

void select(Table& table, const std::vector<std::size_t>& which) {
  Bytes data;
  std::size_t size = 0;
  for (const std::size_t i : which) size += table.row(i).size();
  data.reserve(size);
  std::vector<std::uint64_t> start;
  if (!table.start.empty()) {
    start.reserve(which.size() + 1);
    start.push_back(0);
  }
  for (std::size_t k = 0; k < which.size(); ++k) {
    const std::string_view row = table.row(which[k]);
    data.insert(data.end(), row.begin(), row.end());
    // The last line of a file may lack its line end; it needs one where it is no longer the last.
    if (table.text && (row.empty() || row.back() != '\n') && k + 1 < which.size()) data.push_back('\n');
    if (!table.start.empty()) start.push_back(data.size());
  }
  // Comments stay in front of the first kept row that stood behind them in the file. They are ascending, so
  // what was before one of them need not be looked at again for the next.
  std::size_t k = 0;
  for (Interlude& note : table.interludes) {
    while (k < which.size() && which[k] < note.row) ++k;
    note.row = k;
  }
  table.data = std::move(data);
  table.start = std::move(start);
  table.count = which.size();
}

}  // namespace rfsmooth::pipeline::io
