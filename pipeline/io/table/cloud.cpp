#include "pipeline/io/table/cloud.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/io/formats/header_lines.h"

namespace rfsmooth::pipeline::io {
namespace {

// The elements that name points by index, and what becomes of them when the points `rows` stay.
std::vector<std::pair<std::size_t, Table>> renumbered(const Cloud& cloud,
                                                      const std::vector<std::size_t>& rows,
                                                      const Context& context) {
  std::vector<std::pair<std::size_t, Table>> changed;
  std::vector<Index> number;
  for (std::size_t e = 0; e < cloud.elements.size(); ++e) {
    const auto which = fields_of_indices(cloud.elements[e]);
    if (e == cloud.vertex || which.empty()) continue;
    if (number.empty()) {
      number.assign(cloud.size(), kNone);
      for (std::size_t i = rows.size(); i-- > 0;) number[rows[i]] = Index(i);
    }
    changed.emplace_back(e, cloud.elements[e]);
    renumber(changed.back().second, which, number, context);
  }
  return changed;
}

// Fields that programs write in lower and upper case alike; others of another case are other fields.
constexpr std::array<std::string_view, 12> kAnyCase = {
    "nx", "ny", "nz", "normal_x", "normal_y", "normal_z", "red", "green", "blue", "alpha", "rgb", "rgba"};

bool same_but_for_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [&](char c, char d) { return lower(c) == lower(d); });
}

template <class Same>
std::optional<std::size_t> first_field(const Cloud& cloud, std::string_view name, Same&& same) {
  const std::vector<Field>& fields = cloud.points().fields;
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return same(f.name, name); });
  if (found == fields.end()) return std::nullopt;
  return std::size_t(found - fields.begin());
}

// R, G and B are colours where all three are there; one of them alone may be anything.
std::optional<std::size_t> colour_by_letter(const Cloud& cloud, std::string_view name) {
  if (name != "red" && name != "green" && name != "blue") return std::nullopt;
  for (const std::string_view letter : {"r", "g", "b"})
    if (!first_field(cloud, letter, same_but_for_case)) return std::nullopt;
  return first_field(cloud, name.substr(0, 1), same_but_for_case);
}

}  // namespace

std::string_view name_of(Format format) {
  constexpr std::array<std::string_view, 5> kNames = {"ply", "pcd", "xyz", "off", "las"};
  return kNames.at(std::size_t(format));
}

std::string_view name_of(Encoding encoding) {
  constexpr std::array<std::string_view, 4> kNames = {"ascii", "binary_little_endian", "binary_big_endian",
                                                      "binary_compressed"};
  return kNames.at(std::size_t(encoding));
}

const Table* Cloud::element(std::string_view name) const {
  for (const Table& t : elements)
    if (t.name == name) return &t;
  return nullptr;
}

std::vector<double> positions(const Cloud& cloud, const Context& context) {
  return gather(cloud.points(), {cloud.xyz.begin(), cloud.xyz.end()}, context);
}

Positions points_of(const std::vector<double>& xyz) {
  Positions points;
  points.reserve(xyz.size() / 3);
  for (std::size_t i = 0; i < xyz.size(); i += 3) points.emplace_back(&xyz[i]);
  return points;
}

std::size_t finite_rows(const std::vector<double>& xyz, const Context& context) {
  return sum_over(context, xyz.size() / 3, std::size_t{0},
                  [&](std::size_t i) { return std::size_t(finite_row(&xyz[3 * i])); });
}

bool can_hold(const std::array<Field, 3>& fields, const Eigen::Vector3d& xyz) {
  return can_hold(fields[0], xyz[0]) && can_hold(fields[1], xyz[1]) && can_hold(fields[2], xyz[2]);
}

void warn_of_rounding(const std::array<Field, 3>& fields, std::size_t beyond, const Context& context) {
  if (beyond > 0)
    context.warn(fmt::format(
        "beyond what the file's scale and offset can say: {}, put at the end of the range, or kept "
        "where a coordinate is not finite",
        counted(beyond, "point")));
  const auto whole = std::find_if(fields.begin(), fields.end(), [](const Field& f) { return f.is_whole(); });
  if (whole != fields.end())
    context.warn(fmt::format("the coordinates are whole numbers ({}): new ones are rounded to whole numbers",
                             name_of(whole->type)));
}

void set_positions(Cloud& cloud, const double* xyz, const Context& context) {
  const std::vector<Field>& fields = cloud.points().fields;
  const std::array<Field, 3> of_xyz = {fields[cloud.xyz[0]], fields[cloud.xyz[1]], fields[cloud.xyz[2]]};
  const auto beyond = [&](std::size_t i) {
    return std::size_t(!can_hold(of_xyz, Eigen::Vector3d(xyz + 3 * i)));
  };
  warn_of_rounding(of_xyz, sum_over(context, cloud.size(), std::size_t{0}, beyond), context);
  scatter(cloud.points(), {cloud.xyz.begin(), cloud.xyz.end()}, xyz, context);
}

std::optional<std::size_t> find_field(const Cloud& cloud, std::string_view name) {
  auto found = first_field(cloud, name, std::equal_to<>());
  if (found || std::find(kAnyCase.begin(), kAnyCase.end(), name) == kAnyCase.end()) return found;
  found = first_field(cloud, name, same_but_for_case);
  return found ? found : colour_by_letter(cloud, name);
}

std::optional<std::size_t> find_plain_field(const Cloud& cloud, std::string_view name) {
  const auto field = find_field(cloud, name);
  return field && cloud.points().fields[*field].is_plain() ? field : std::nullopt;
}

std::vector<double> field_values(const Cloud& cloud, std::size_t field, const Context& context) {
  return gather(cloud.points(), {field}, context);
}

void set_field(Cloud& cloud, const std::string& name, Scalar type, const std::vector<double>& values,
               const Context& context) {
  if (values.size() != cloud.size()) throw std::invalid_argument("set_field: not one value per point");
  check_field(cloud, name, type);
  if (const auto present = find_field(cloud, name))
    scatter(cloud.points(), {*present}, values.data(), context);
  else
    append_field(cloud.points(), Field{name, type}, values.data(), context);
}

void check_field(const Cloud& cloud, const std::string& name, Scalar type) {
  const auto present = find_field(cloud, name);
  if (!present && (name.empty() || one_word(name) != name))
    fail(ErrorCode::usage,
         "{} cannot be the name of a new field: it takes one word, without blanks and control characters",
         in_quotes(name));
  if (!present) return;
  const Field& field = cloud.points().fields[*present];
  if (!field.is_plain())
    fail(ErrorCode::usage, "the points have a field '{}' already, a {}; it cannot take one value per point",
         name, field.is_list() ? "list" : "row of several values");
  if (is_float(type) && field.is_whole())
    fail(ErrorCode::usage,
         "the points have a field '{}' already, of whole numbers ({}); it cannot take values of type {}",
         name, name_of(field.type), name_of(type));
}

void select_points(Cloud& cloud, const std::vector<std::size_t>& rows, const Context& context) {
  bool all = rows.size() == cloud.size();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] >= cloud.size()) throw std::invalid_argument("select_points: no such point");
    all = all && rows[i] == i;
  }
  if (all) return;
  auto others = renumbered(cloud, rows, context);  // made before anything changes: memory may run out
  select(cloud.points(), rows);
  for (auto& [e, table] : others) cloud.elements[e] = std::move(table);
  cloud.width = rows.size();
  cloud.height = 1;
  const auto says_grid = [](const Note& note) {
    return note.line.rfind("obj_info num_cols", 0) == 0 || note.line.rfind("obj_info num_rows", 0) == 0;
  };
  cloud.notes.erase(std::remove_if(cloud.notes.begin(), cloud.notes.end(), says_grid), cloud.notes.end());
}

Cloud make_cloud(const double* xyz, std::size_t n, Scalar type) {
  Cloud cloud;
  cloud.width = n;
  cloud.xyz = {0, 1, 2};
  Table points;
  points.name = "vertex";
  points.fields = {{"x", type}, {"y", type}, {"z", type}};
  points.count = n;
  points.data.resize(3 * n * size_of(type));
  for (std::size_t k = 0; k < 3 * n; ++k) store(type, points.data.data() + k * size_of(type), xyz[k]);
  cloud.elements.push_back(std::move(points));
  return cloud;
}

}  // namespace rfsmooth::pipeline::io
