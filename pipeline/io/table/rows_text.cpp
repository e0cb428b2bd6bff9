#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::size_t kTextRowsPerBlock = 4096;

// Other texts than XYZ have no columns of words.
std::string not_a_value(const Table& table, std::string_view what, const Field& f, Scalar type,
                        std::string_view word) {
  return fmt::format("expected {} '{}' ({}), found {}{}", what, f.name, name_of(type), in_quotes(word),
                     table.separators == Separators::space
                         ? ""
                         : "; columns of text are not read: take them out of the file");
}

// The same as `problem`, of a row of cells.
std::string problem_of_cells(const Table& table, std::string_view row) {
  const auto cells = words_of(row, table.separators);
  for (std::size_t k = 0; k < std::min(cells.size(), table.fields.size()); ++k)
    if (const Field& f = table.fields[k]; !cells[k].empty() && !is_value(cells[k], f.type))
      return not_a_value(table, "a value of", f, f.type, cells[k]);
  if (cells.size() == table.fields.size()) return {};
  return fmt::format("expected {}, found {}", counted(table.fields.size(), "value"), cells.size());
}

// Empty if the row is what its fields ask for; else what was expected and found.
std::string problem(const Table& table, std::string_view row) {
  if (cell_separator(table.separators) != '\0') return problem_of_cells(table, row);
  const std::size_t size = row.size();
  std::size_t seen = 0, wanted = 0;
  const auto take = [&](const Field& f, Scalar type, const char* what) -> std::string {
    const std::string_view word = next_word(row, table.separators);
    ++wanted;
    if (word.empty())
      return fmt::format("expected {} '{}' as value {}, found the end of the line", what, f.name, wanted);
    ++seen;
    if (is_value(word, type)) return {};
    return not_a_value(table, what, f, type, word);
  };
  for (const Field& f : table.fields) {
    std::size_t n = f.count;
    if (f.is_list()) {
      std::string_view before = row;
      if (std::string bad = take(f, *f.list_count, "the length of list"); !bad.empty()) return bad;
      const std::string_view word = next_word(before, table.separators);
      n = std::size_t(parse_integer(word, *f.list_count).value());
      if (word.front() == '-' || n > size)
        return fmt::format("expected the length of list '{}', found {}", f.name, in_quotes(word));
    }
    for (std::size_t k = 0; k < n; ++k)
      if (std::string bad = take(f, f.type, "a value of"); !bad.empty()) return bad;
  }
  if (table.ragged) return {};
  const std::string_view word = next_word(row, table.separators);
  if (word.empty()) return {};
  return fmt::format("expected {}, found more: {}", counted(seen, "value"), in_quotes(word));
}

}  // namespace

TextCursor::TextCursor(const Source& from, std::uint64_t offset, std::size_t lines_before,
                       const Context& context)
    : source(from), all(from.read(offset, std::size_t(from.size() - offset), context)), lines(lines_before) {}

bool is_blank_or_comment(std::string_view line) {
  const std::string_view word = next_word(line);
  return word.empty() || word.front() == '#' || word.substr(0, 2) == "//";
}

std::string_view peek_line(const TextCursor& cursor) {
  const std::string_view rest = cursor.rest();
  const std::size_t newline = rest.find('\n');
  return newline == std::string_view::npos ? rest : rest.substr(0, newline + 1);
}

void skip_line(TextCursor& cursor) {
  const std::size_t n = peek_line(cursor).size();
  cursor.at += n;
  if (n > 0) ++cursor.lines;
}

void count_text_rows(Table& table, const TextCursor& cursor) {
  table.count = 0;
  const char* p = cursor.all.data() + cursor.at;
  const char* end = cursor.all.data() + cursor.all.size();
  while (p != end) {
    const char* newline = static_cast<const char*>(std::memchr(p, '\n', std::size_t(end - p)));
    const char* next = newline == nullptr ? end : newline + 1;
    if (!is_blank_or_comment({p, std::size_t(next - p)})) ++table.count;
    p = next;
  }
}

namespace {

/// Fails at the first row whose values are not those of its fields.
void check_rows(const Table& table, const Source& source, std::size_t lines_before, const Context& context) {
  const auto bad = reduce_blocks(
      context, table.count, table.count,
      [&](std::size_t begin, std::size_t stop) {
        for (std::size_t i = begin; i < stop; ++i)
          if (!problem(table, table.row(i)).empty()) return i;
        return table.count;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); }, kTextRowsPerBlock);
  if (bad == table.count) return;
  std::size_t line = lines_before + bad + 1;
  for (const Interlude& note : table.interludes)
    if (note.row <= bad) line += std::size_t(std::count(note.text.begin(), note.text.end(), '\n'));
  source.fail("line {}: {}", line, problem(table, table.row(bad)));
}

}  // namespace

void read_text_rows(Table& table, TextCursor& cursor, const Context& context) {
  table.text = true;
  if (table.count == 0) return;
  // The shortest line holds one character per value, what parts them, and a line end.
  const std::size_t left = cursor.all.size() - cursor.at;
  if (table.count > (left + 1) / 2)
    cursor.source.fail("line {}: expected {} of element '{}', found {}", cursor.lines + 1,
                       counted(table.count, "line"), table.name, counted(left, "byte"));

  // Blank lines and comments are taken out, and the rows moved together where they are.
  char* const begin = cursor.all.data() + cursor.at;
  char* const end = begin + left;
  char* rows_end = begin;  // behind the rows moved so far
  char* run = begin;       // first byte not yet moved
  char* p = begin;
  const auto move_run = [&] {
    if (run != rows_end) std::memmove(rows_end, run, std::size_t(p - run));
    rows_end += p - run;
  };
  const std::size_t lines_before = cursor.lines;
  table.start.reserve(table.count + 1);
  table.start.push_back(0);
  std::size_t rows = 0;
  while (rows < table.count) {
    if (rows % kTextRowsPerBlock == 0) context.check_stop();
    if (p == end)
      cursor.source.fail("line {}: expected row {} of {} of element '{}', found the end of the file",
                         cursor.lines + 1, rows + 1, table.count, table.name);
    char* const newline = static_cast<char*>(std::memchr(p, '\n', std::size_t(end - p)));
    char* const next = newline == nullptr ? end : newline + 1;
    if (newline != nullptr) ++cursor.lines;
    const std::string_view line(p, std::size_t(next - p));
    if (is_blank_or_comment(line)) {
      if (!table.interludes.empty() && table.interludes.back().row == rows)
        table.interludes.back().text += line;
      else
        table.interludes.push_back({rows, std::string(line)});
      move_run();
      run = next;
    } else {
      ++rows;
      table.start.push_back(std::uint64_t(rows_end - begin) + std::uint64_t(next - run));
    }
    p = next;
  }
  move_run();
  const std::size_t first = cursor.at;
  cursor.at += std::size_t(p - begin);
  table.data = take_bytes(cursor.all, first, std::size_t(rows_end - begin), cursor.at);
  check_rows(table, cursor.source, lines_before, context);
}

void write_text_rows(const Table& table, Sink& sink, const Context& context) {
  if (!table.text) {
    Table copy = table;
    make_text(copy, context);
    return write_text_rows(copy, sink, context);
  }
  std::size_t from = 0;
  for (const Interlude& note : table.interludes) {
    const std::size_t to = note.row < table.count ? std::size_t(table.start[note.row]) : table.data.size();
    sink.write({table.data.data() + from, to - from});
    sink.write(note.text);
    from = to;
  }
  sink.write({table.data.data() + from, table.data.size() - from});
}

void write_text_body(const std::vector<const Table*>& tables, std::string_view tail, Sink& sink,
                     const Context& context) {
  bool open = false;  // whether the last line lacks its line end
  const auto close_line = [&] {
    if (open) sink.write("\n");
    open = false;
  };
  for (const Table* table : tables) {
    context.check_stop();
    if (table->count == 0 && table->interludes.empty()) continue;
    close_line();
    write_text_rows(*table, sink, context);
    open = table->text && !table->data.empty() && table->data.back() != '\n';
  }
  if (!tail.empty()) close_line();
  sink.write(tail);
}

}  // namespace rfsmooth::pipeline::io
