#include "pipeline/io/table/table.h"

#include <cmath>
#include <stdexcept>

#include "pipeline/io/table/table_walk.h"

namespace rfsmooth::pipeline::io {
namespace {

void require_plain(const Table& table, const std::vector<std::size_t>& which) {
  for (const std::size_t f : which)
    if (!table.fields.at(f).is_plain())
      throw std::invalid_argument("'" + table.fields[f].name + "' is not one value per row");
}

bool same(double a, double b) {
  return (a == b && std::signbit(a) == std::signbit(b)) || (std::isnan(a) && std::isnan(b));
}

void scatter_binary(Table& table, const std::vector<std::size_t>& which, const double* values,
                    const Context& context) {
  const Locator locate(table);
  context.check_stop();
  Context to_the_end = context;  // in place: all rows or none
  to_the_end.stop = nullptr;
  for_blocks(to_the_end, table.count, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < which.size(); ++k) {
        char* p = const_cast<char*>(locate(table.row(i).data(), which[k]));
        const Field& field = table.fields[which[k]];
        const double value = values[i * which.size() + k];
        if (!same(load(field, p), value)) store(field, p, value);
      }
  });
}

// The types whose digits are written: float fields whose text says more than floats hold are written like
// doubles.
std::vector<Scalar> text_types(const Table& table, const std::vector<std::size_t>& which,
                               const Context& context) {
  std::vector<Scalar> types;
  std::vector<std::size_t> narrow;
  for (const std::size_t f : which) {
    types.push_back(table.fields[f].type);
    if (types.back() == Scalar::float32) narrow.push_back(f);
  }
  if (narrow.empty() || text_fits_float32(table, narrow, context)) return types;
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
        if (same(value_of(words[0]), value)) continue;
        out.append(copied, words[0].data());
        append_number(out, value, types[k]);
        copied = words[0].data() + words[0].size();
      }
    });
    out.append(copied, row.data() + row.size());
  });
}

}  // namespace

bool text_fits_float32(const Table& table, const std::vector<std::size_t>& which, const Context& context) {
  const auto block = [&](std::size_t begin, std::size_t end) {
    bool fits = true;
    for (std::size_t i = begin; i < end && fits; ++i)
      for_each_field(table, table.row(i), [&](std::size_t f, const std::vector<std::string_view>& words) {
        for (const std::size_t w : which) fits = fits && (w != f || fits_float32(words[0]));
      });
    return char(fits);
  };
  return reduce_blocks(context, table.count, char{1}, block, [](char a, char b) { return char(a & b); }) != 0;
}

bool Table::has_lists() const {
  for (const Field& f : fields)
    if (f.is_list()) return true;
  return false;
}

std::size_t Table::offset_of(std::size_t field) const {
  std::size_t offset = 0;
  for (std::size_t f = 0; f < field; ++f) {
    if (fields[f].is_list()) throw std::logic_error("rows with lists have no fixed size");
    offset += fields[f].bytes();
  }
  return offset;
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
          out[k] = load(table.fields[which[k]], locate(row, which[k]));
      } else {
        for_each_field(table, table.row(i), [&](std::size_t f, const std::vector<std::string_view>& words) {
          for (std::size_t k = 0; k < which.size(); ++k)
            if (which[k] == f) out[k] = value_of(words[0]);
        });
      }
    }
  });
  return values;
}

Lists gather_lists(const Table& table, std::size_t field, const Context& context) {
  const Field& f = table.fields.at(field);
  const Locator locate(table);
  Lists lists;
  lists.start.reserve(table.count + 1);
  lists.start.push_back(0);
  for (std::size_t i = 0; i < table.count; ++i) {
    if (i % kRowsPerBlock == 0) context.check_stop();
    if (table.text) {
      for_each_field(table, table.row(i), [&](std::size_t at, const std::vector<std::string_view>& words) {
        if (at != field) return;
        for (std::size_t k = f.is_list() ? 1 : 0; k < words.size(); ++k)
          lists.values.push_back(parse_real(words[k]).value());
      });
    } else {
      const char* p = locate(table.row(i).data(), field);
      std::size_t n = f.count;
      if (f.is_list()) {
        n = list_size(*f.list_count, p);
        p += size_of(*f.list_count);
      }
      for (std::size_t k = 0; k < n; ++k) lists.values.push_back(load(f.type, p + k * size_of(f.type)));
    }
    lists.start.push_back(lists.values.size());
  }
  return lists;
}

std::vector<std::size_t> list_lengths(const Table& table, std::size_t field, const Context& context) {
  const Field& f = table.fields.at(field);
  const Locator locate(table);
  std::vector<std::size_t> lengths(table.count, f.count);
  if (!f.is_list()) return lengths;
  for_each_index(context, table.count, [&](std::size_t i) {
    const std::string_view row = table.row(i);
    if (!table.text)
      lengths[i] = list_size(*f.list_count, locate(row.data(), field));
    else
      for_each_field(table, row, [&](std::size_t at, const std::vector<std::string_view>& words) {
        if (at == field) lengths[i] = words.size() - 1;
      });
  });
  return lengths;
}

void scatter(Table& table, const std::vector<std::size_t>& which, const double* values,
             const Context& context) {
  require_plain(table, which);
  if (table.text)
    scatter_text(table, which, values, context);
  else
    scatter_binary(table, which, values, context);
}

void make_text(Table& table, const Context& context) {
  if (table.text) return;
  const Table& old = table;
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const char* p = old.row(i).data();
    bool first = true;
    const auto take = [&](Scalar type) {
      if (!first) out += ' ';
      first = false;
      append_stored(out, p, type);
      p += size_of(type);
    };
    for (const Field& field : old.fields) {
      const std::size_t n = field.is_list() ? list_size(*field.list_count, p) : field.count;
      if (field.is_list()) take(*field.list_count);
      for (std::size_t k = 0; k < n; ++k) take(field.type);
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
