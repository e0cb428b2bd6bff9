#include "rfsmooth/pipeline/io/table.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::size_t kRowsPerBlock = 8192;

void require_plain(const Table& table, const std::vector<std::size_t>& which) {
  for (const std::size_t f : which)
    if (!table.fields.at(f).is_plain())
      throw std::invalid_argument("'" + table.fields[f].name + "' is not one value per row");
}

std::size_t list_size(Scalar type, const char* p) {
  return std::size_t(load(type, p));
}

// Where each of `which` starts in the binary row at `p`; offsets of fields behind a list differ from row to
// row.
struct Locator {
  explicit Locator(const Table& table) : fields(table.fields), fixed(!table.has_lists()) {
    std::size_t offset = 0;
    for (const Field& f : fields) {
      offsets.push_back(offset);
      if (fixed) offset += f.count * size_of(f.type);
    }
  }
  const char* operator()(const char* row, std::size_t field) const {
    if (fixed) return row + offsets[field];
    for (std::size_t f = 0; f < field; ++f) row += bytes_of(fields[f], row);
    return row;
  }
  static std::size_t bytes_of(const Field& f, const char* p) {
    if (!f.is_list()) return f.count * size_of(f.type);
    return size_of(*f.list_count) + list_size(*f.list_count, p) * size_of(f.type);
  }
  const std::vector<Field>& fields;
  bool fixed;
  std::vector<std::size_t> offsets;
};

// Calls body(field, words of that field) along a text row; a list's words come with its count in front.
template <class Body>
void for_each_field(const Table& table, std::string_view row, Body&& body) {
  const char* p = row.data();
  const char* end = p + row.size();
  std::vector<std::string_view> words;
  for (std::size_t f = 0; f < table.fields.size(); ++f) {
    words.clear();
    const Field& field = table.fields[f];
    std::size_t n = field.count;
    if (field.is_list()) {
      words.push_back(next_word(p, end, table.separators));
      n = std::size_t(parse_integer(words.back(), *field.list_count).value());
    }
    for (std::size_t k = 0; k < n; ++k) words.push_back(next_word(p, end, table.separators));
    body(f, words);
  }
}

bool same(double a, double b) {
  return (a == b && std::signbit(a) == std::signbit(b)) || (std::isnan(a) && std::isnan(b));
}

// Builds new rows block by block in parallel: make(i, out) appends row i.
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

// Behind the last value of a text row: where its trailing blanks and line end begin.
std::size_t content_size(std::string_view row, Separators separators) {
  std::size_t n = row.size();
  while (n > 0 && is_separator(row[n - 1], separators)) --n;
  return n;
}

void scatter_binary(Table& table, const std::vector<std::size_t>& which, const double* values,
                    const Context& context) {
  const Locator locate(table);
  for_blocks(context, table.count, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < which.size(); ++k) {
        char* p = const_cast<char*>(locate(table.row(i).data(), which[k]));
        const Scalar type = table.fields[which[k]].type;
        const double value = values[i * which.size() + k];
        if (!same(load(type, p), value)) store(type, p, value);
      }
  });
}

// The type whose digits are written: a float field whose text says more than floats hold is written like a
// double.
std::vector<Scalar> text_types(const Table& table, const std::vector<std::size_t>& which,
                               const Context& context) {
  std::vector<Scalar> types;
  for (const std::size_t f : which) types.push_back(table.fields[f].type);
  bool any = false;
  for (const Scalar type : types) any = any || type == Scalar::float32;
  if (!any) return types;
  const bool narrow = reduce_blocks(
      context, table.count, char{1},
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          bool fits = true;
          for_each_field(table, table.row(i), [&](std::size_t f, const std::vector<std::string_view>& words) {
            for (const std::size_t w : which)
              if (w == f && table.fields[f].type == Scalar::float32) fits = fits && fits_float32(words[0]);
          });
          if (!fits) return char{0};
        }
        return char{1};
      },
      [](char a, char b) { return char(a & b); });
  if (!narrow)
    for (Scalar& type : types)
      if (type == Scalar::float32) type = Scalar::float64;
  return types;
}

void scatter_text(Table& table, const std::vector<std::size_t>& which, const double* values,
                  const Context& context) {
  const std::vector<Scalar> types = text_types(table, which, context);
  const Table& old = table;
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const std::string_view row = old.row(i);
    const char* copied = row.data();
    for_each_field(old, row, [&](std::size_t f, const std::vector<std::string_view>& words) {
      for (std::size_t k = 0; k < which.size(); ++k) {
        if (which[k] != f) continue;
        const double value = values[i * which.size() + k];
        if (same(parse_real(words[0]).value(), value)) continue;
        out.append(copied, words[0].data());
        append_number(out, value, types[k]);
        copied = words[0].data() + words[0].size();
      }
    });
    out.append(copied, row.data() + row.size());
  });
}

}  // namespace

bool count_fits(Scalar type, std::uint64_t n) {
  char p[8];
  if (n > (std::uint64_t{1} << 53)) return false;
  store(type, p, double(n));
  return !is_float(type) && load(type, p) == double(n);
}

bool Table::has_lists() const {
  for (const Field& f : fields)
    if (f.is_list()) return true;
  return false;
}

std::size_t Table::row_size() const {
  std::size_t size = 0;
  for (const Field& f : fields) {
    if (f.is_list()) throw std::logic_error("rows with lists have no fixed size");
    size += f.count * size_of(f.type);
  }
  return size;
}

std::size_t Table::values_per_row() const {
  std::size_t n = 0;
  for (const Field& f : fields) n += f.count;
  return n;
}

std::string_view Table::row(std::size_t i) const {
  if (!start.empty()) return {data.data() + start[i], std::size_t(start[i + 1] - start[i])};
  const std::size_t size = count == 0 ? 0 : data.size() / count;
  return {data.data() + i * size, size};
}

std::vector<double> gather(const Table& table, const std::vector<std::size_t>& which,
                           const Context& context) {
  require_plain(table, which);
  std::vector<double> values(table.count * which.size());
  const Locator locate(table);
  for_blocks(context, table.count, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double* out = values.data() + i * which.size();
      if (!table.text) {
        const char* row = table.row(i).data();
        for (std::size_t k = 0; k < which.size(); ++k)
          out[k] = load(table.fields[which[k]].type, locate(row, which[k]));
      } else {
        for_each_field(table, table.row(i), [&](std::size_t f, const std::vector<std::string_view>& words) {
          for (std::size_t k = 0; k < which.size(); ++k)
            if (which[k] == f) out[k] = parse_real(words[0]).value();
        });
      }
    }
  });
  return values;
}

void scatter(Table& table, const std::vector<std::size_t>& which, const double* values,
             const Context& context) {
  require_plain(table, which);
  if (table.text)
    scatter_text(table, which, values, context);
  else
    scatter_binary(table, which, values, context);
}

void append_field(Table& table, const Field& field, const double* values, const Context& context) {
  if (!field.is_plain())
    throw std::invalid_argument("append_field: '" + field.name + "' is not one value per row");
  const Table& old = table;
  if (table.text) {
    rebuild(table, context, [&](std::size_t i, std::string& out) {
      const std::string_view row = old.row(i);
      const std::size_t n = content_size(row, old.separators);
      out.append(row.substr(0, n));
      out += ' ';
      append_number(out, values[i], field.type);
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
  table.fields.push_back(field);
}

void remove_field(Table& table, std::size_t which, const Context& context) {
  if (which >= table.fields.size()) throw std::invalid_argument("remove_field: no such field");
  const Table& old = table;
  if (table.text) {
    rebuild(table, context, [&](std::size_t i, std::string& out) {
      const std::string_view row = old.row(i);
      const char *from = row.data(), *to = row.data();
      for_each_field(old, row, [&](std::size_t f, const std::vector<std::string_view>& words) {
        if (f != which || words.empty()) return;
        from = words.front().data();
        to = words.back().data() + words.back().size();
      });
      const char* end = row.data() + row.size();
      // One separator goes with the value: the one behind it, or before the last value of a line.
      const char* content_end = row.data() + content_size(row, old.separators);
      if (to < content_end) {
        while (to < content_end && is_separator(*to, old.separators)) ++to;
      } else {
        while (from > row.data() && is_separator(from[-1], old.separators)) --from;
      }
      out.append(row.data(), from);
      out.append(to, end);
    });
  } else {
    const bool fixed = !table.has_lists();
    const Locator locate(table);
    rebuild(table, context, [&](std::size_t i, std::string& out) {
      const std::string_view row = old.row(i);
      const char* from = locate(row.data(), which);
      const char* to = from + Locator::bytes_of(old.fields[which], from);
      out.append(row.data(), from);
      out.append(to, row.data() + row.size());
    });
    if (fixed) table.start.clear();
  }
  table.fields.erase(table.fields.begin() + std::ptrdiff_t(which));
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
  for (const std::size_t i : which) {
    const std::string_view row = table.row(i);
    data.insert(data.end(), row.begin(), row.end());
    // The last line of a file may lack its line end; it needs one where it is no longer the last.
    if (table.text && (row.empty() || row.back() != '\n') && data.size() < size) data.push_back('\n');
    if (!table.start.empty()) start.push_back(data.size());
  }
  // Comments stay in front of the first kept row that stood behind them in the file.
  for (Interlude& note : table.interludes) {
    std::size_t k = 0;
    while (k < which.size() && which[k] < note.row) ++k;
    note.row = k;
  }
  table.data = std::move(data);
  table.start = std::move(start);
  table.count = which.size();
}

void make_text(Table& table, const Context& context) {
  if (table.text) return;
  const Table& old = table;
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const char* p = old.row(i).data();
    bool first = true;
    for (const Field& field : old.fields) {
      std::size_t n = field.count;
      if (field.is_list()) {
        n = list_size(*field.list_count, p);
        if (!first) out += ' ';
        first = false;
        append_stored(out, p, *field.list_count);
        p += size_of(*field.list_count);
      }
      for (std::size_t k = 0; k < n; ++k, p += size_of(field.type)) {
        if (!first) out += ' ';
        first = false;
        append_stored(out, p, field.type);
      }
    }
    out += '\n';
  });
  table.text = true;
  table.separators = Separators::space;
}

void make_binary(Table& table, const Context& context) {
  if (!table.text) return;
  const Table& old = table;
  const bool fixed = !table.has_lists();
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    for_each_field(old, old.row(i), [&](std::size_t f, const std::vector<std::string_view>& words) {
      const Field& field = old.fields[f];
      for (std::size_t k = 0; k < words.size(); ++k) {
        const Scalar type = field.is_list() && k == 0 ? *field.list_count : field.type;
        char p[8];
        store_text(words[k], type, p);
        out.append(p, size_of(type));
      }
    });
  });
  if (fixed) table.start.clear();
  table.text = false;
  table.ragged = false;
  table.interludes.clear();
}

}  // namespace rfsmooth::pipeline::io
