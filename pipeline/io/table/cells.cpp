#include <stdexcept>

#include "pipeline/io/table/table.h"
#include "pipeline/io/table/table_walk.h"

namespace rfsmooth::pipeline::io {
namespace {

// A row's cells without the blanks and the line end behind them; a tab may belong to an empty last cell.
std::string_view cells_in(std::string_view row) {
  const std::size_t last = row.find_last_not_of(" \r\n");
  return row.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

}  // namespace

void add_field(Table& table, const Field& field, const double* values, const Context& context) {
  const char separator = table.text ? cell_separator(table.separators) : '\0';
  if (separator == '\0') return append_field(table, field, values, context);
  if (!field.is_plain()) throw std::invalid_argument("'" + field.name + "' is not one value per row");
  std::vector<Field> fields = table.fields;  // made before anything changes: memory may run out
  fields.push_back(field);
  const Table& old = table;
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    const std::string_view row = old.row(i), cells = cells_in(row);
    const bool quoted = !cells.empty() && cells.back() == '"';
    out.append(cells) += separator;
    if (quoted) out += '"';
    append_number(out, values[i], field.type);
    if (quoted) out += '"';
    out.append(row.substr(cells.size()));
  });
  table.fields = std::move(fields);
}

void make_words(Table& table, const Context& context) {
  if (!table.text || table.separators == Separators::space) return;
  const Table& old = table;
  rebuild(table, context, [&](std::size_t i, std::string& out) {
    bool first = true;
    for (const std::string_view word : words_of(old.row(i), old.separators)) {
      if (!first) out += ' ';
      first = false;
      out.append(word.empty() ? "nan" : word);
    }
    out += '\n';
  });
  table.separators = Separators::space;
}

}  // namespace rfsmooth::pipeline::io
