#include "pipeline/io/convert/notes.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pipeline/io/convert/capacity.h"
#include "pipeline/io/table/text.h"

namespace rfsmooth::pipeline::io {

namespace {

std::string_view without_keyword(std::string_view line) {
  for (const std::string_view keyword : {"comment", "#", "//"})
    if (line.substr(0, keyword.size()) == keyword) {
      line.remove_prefix(keyword.size());
      break;
    }
  while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
  return line;
}

// The value of "obj_info KEY VALUE", if the line is that.
std::optional<std::string_view> info_value(std::string_view line, std::string_view key) {
  if (next_word(line) != "obj_info" || next_word(line) != key) return std::nullopt;
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  return line;
}

bool is_viewpoint(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  return words.size() == 7 && std::all_of(words.begin(), words.end(), parse_real);
}

// PLY's obj_info lines that say what PCD has words for; they leave the notes.
void take_grid_and_viewpoint(Cloud& cloud) {
  std::size_t columns = 0, rows = 0;
  for (const Note& note : cloud.notes) {
    if (const auto v = info_value(note.line, "num_cols")) columns = parse_count(*v).value_or(0);
    if (const auto v = info_value(note.line, "num_rows")) rows = parse_count(*v).value_or(0);
    if (const auto v = info_value(note.line, "viewpoint"); v && is_viewpoint(*v)) cloud.viewpoint = *v;
  }
  const bool grid = columns > 0 && rows > 0 && cloud.size() % columns == 0 && cloud.size() / columns == rows;
  if (grid) {
    cloud.width = columns;
    cloud.height = rows;
  }
  const auto taken = [&](const Note& note) {
    return (grid && (info_value(note.line, "num_cols") || info_value(note.line, "num_rows"))) ||
           info_value(note.line, "viewpoint") == std::optional<std::string_view>(cloud.viewpoint);
  };
  cloud.notes.erase(std::remove_if(cloud.notes.begin(), cloud.notes.end(), taken), cloud.notes.end());
}

// Comments between text rows go into the header, where every format has a place for them.
void take_interludes(Cloud& cloud) {
  for (Table& table : cloud.elements) {
    for (const Interlude& between : table.interludes) {
      for (std::string_view rest = between.text; !rest.empty();) {
        std::string_view line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(line.size() + 1, rest.size()));
        while (!line.empty() && is_separator(line.back(), Separators::space)) line.remove_suffix(1);
        if (!line.empty()) cloud.notes.push_back({std::string(line)});
      }
    }
    table.interludes.clear();
  }
}

}  // namespace

void rewrite_notes(Cloud& cloud, Format from, Format to) {
  take_interludes(cloud);
  if (from == Format::ply) take_grid_and_viewpoint(cloud);
  const bool as_ply =
      capacity_of(to).grid == Capacity::Grid::notes;  // the texts of LAS are what PLY would say
  const char* keyword = as_ply ? "comment " : "# ";
  for (Note& note : cloud.notes) {
    const bool info = from == Format::ply && note.line.substr(0, 8) == "obj_info";
    note = Note{keyword + std::string(info ? std::string_view(note.line) : without_keyword(note.line))};
    // Read again as ours: a comment "obj_info ..." of another format is obj_info in PLY.
    if (as_ply && note.line.substr(8, 9) == "obj_info ") note.line.erase(0, 8);
  }
  if (!as_ply) return;
  if (cloud.organised()) {
    cloud.notes.push_back({fmt::format("obj_info num_cols {}", cloud.width)});
    cloud.notes.push_back({fmt::format("obj_info num_rows {}", cloud.height)});
  }
  if (cloud.viewpoint != kNoViewpoint) cloud.notes.push_back({"obj_info viewpoint " + cloud.viewpoint});
}

}  // namespace rfsmooth::pipeline::io
