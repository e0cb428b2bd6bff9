/// A cloud (or mesh) file in memory, lossless: what is read and not changed is written back byte for byte.
///
/// Only coordinates, and fields that a caller adds or removes, change. Everything else is kept: field order,
/// types and names, rows with NaN, other PLY elements, comments, width x height, viewpoint. One thread may
/// change a cloud, or several may read it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/cloud_file.h>
#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/result.h>

#include "pipeline/io/table/table.h"

namespace rfsmooth::pipeline::io {

using rfsmooth::Encoding;
using rfsmooth::Format;

std::string_view name_of(Format format);      ///< "ply", "pcd", "xyz", "off", "las"
std::string_view name_of(Encoding encoding);  ///< as PLY and PCD headers write them ("binary_little_endian")

/// A comment or obj_info line of a header, without its line end, and its place: before property `field` - 1
/// of element `element`. `field` 0: before the element's own line. `element` kBeforeFormat: before PLY's
/// format line.
struct Note {
  static constexpr std::size_t kBeforeFormat = std::size_t(-1);
  std::string line;
  std::size_t element = 0;
  std::size_t field = 0;
};

/// What an XYZ file says before its first point, besides comments.
struct XyzStyle {
  std::optional<std::uint64_t> counted;  ///< the number of points, on a line of its own (.pts)
  std::size_t notes_first = 0;           ///< of the comments, those that come before that line
  bool names_first = false;              ///< whether the line of names does
  std::optional<std::string> names;      ///< the start of a line that names the columns ("//", "# ", "")
  char separator = ' ';                  ///< between those names
  std::vector<std::string> cells;        ///< those names as written, with quotes and units
};

/// A file in memory: every element and field, known or not.
struct Cloud {
  Format format = Format::ply;
  Encoding encoding = Encoding::binary_little_endian;

  std::vector<Table> elements;       ///< in file order; PCD and XYZ have the points only
  std::size_t vertex = 0;            ///< which of them holds the points
  std::array<std::size_t, 3> xyz{};  ///< the fields x, y, z of the points

  std::size_t width = 0, height = 1;        ///< width x height = points; height 1 = unorganised
  std::string viewpoint = "0 0 0 1 0 0 0";  ///< PCD: translation and quaternion (w x y z), as written
  std::vector<Note> notes;                  ///< comments and obj_info, in file order
  XyzStyle xyz_style;

  // How the file was written, so that an unchanged one comes back the same.
  std::string newline = "\n";
  std::string original_header;     ///< verbatim
  std::string original_canonical;  ///< as we would write it
  std::string tail;                ///< bytes after the last row

  Table& points() { return elements[vertex]; }
  const Table& points() const { return elements[vertex]; }
  std::size_t size() const { return points().count; }
  bool organised() const { return height > 1; }

  /// The element of that name, or null.
  const Table* element(std::string_view name) const;

  /// The header to write, of a text that says the same as `canonical`: the file's own, if that has not
  /// changed.
  std::string header(const std::string& canonical) const {
    return canonical == original_canonical ? original_header : canonical;
  }
};

/// The coordinates, n x 3 row-major, as doubles; those of text with all their digits, whatever the type.
/// O(n), parallel.
std::vector<double> positions(const Cloud& cloud, const Context& context = {});

/// The same rows as points. O(n).
Positions points_of(const std::vector<double>& xyz);

/// Whether x, y and z are finite.
inline bool finite_row(const double* xyz) {
  return std::isfinite(xyz[0]) && std::isfinite(xyz[1]) && std::isfinite(xyz[2]);
}

/// How many rows are, of n x 3. O(n), parallel.
std::size_t finite_rows(const std::vector<double>& xyz, const Context& context = {});

/// Writes n x 3 coordinates back, each in its own type, floats rounded to nearest. A coordinate equal to the
/// present one keeps its bytes or text. Integer coordinates are rounded to whole numbers and a warning is
/// logged. Scaled ones (LAS) are rounded to their scale; a warning is logged for what is beyond their range.
void set_positions(Cloud& cloud, const double* xyz, const Context& context = {});

/// Whether the fields x, y, z of a row can say a place, but for rounding.
bool can_hold(const std::array<Field, 3>& fields, const Eigen::Vector3d& xyz);

/// The warnings of set_positions: that whole numbers are rounded, and that so many points are `beyond` what
/// scaled fields can say.
void warn_of_rounding(const std::array<Field, 3>& fields, std::size_t beyond, const Context& context);

/// The field of the points with that name (the first of several), or none. The names of normals and colours
/// (nx, normal_x, red, alpha, rgb, ...) stand for those in upper case, too, where none is written so; red,
/// green and blue for R, G and B where all three are there.
std::optional<std::size_t> find_field(const Cloud& cloud, std::string_view name);

/// The same if that field is plain.
std::optional<std::size_t> find_plain_field(const Cloud& cloud, std::string_view name);

/// The values of a plain field, one double per point. \throw std::invalid_argument if it is a list or an
/// array.
std::vector<double> field_values(const Cloud& cloud, std::size_t field, const Context& context = {});

/// Sets a field of the points (displacement, outlier, normals):
///
/// - if there is none of that name, which is one word, it is appended behind the points' last field, as
///   `type`; every other byte stays.
/// - if there is one (the first of several), its values are replaced in place, in its own type.
///
/// \throw Failure (usage) if that one cannot take the values; `check_field` tells in advance.
void set_field(Cloud& cloud, const std::string& name, Scalar type, const std::vector<double>& values,
               const Context& context = {});

/// Refuses what `set_field` cannot do: the field of that name is a list or an array, or an integer field
/// where `type` is a float, or there is none and the name is not one word. \throw Failure (usage) naming
/// field and type.
void check_field(const Cloud& cloud, const std::string& name, Scalar type);

/// Keeps the points `rows`, in that order. Unless these are all points in order, the result is not organised.
/// Rows of elements that name points by index (lists called vertex_indices or vertex_index; vertex1, vertex2)
/// stay where all of their points do, and get the new indices; strips of triangles (tristrips) are cut.
/// \throw std::invalid_argument if there is no such row.
void select_points(Cloud& cloud, const std::vector<std::size_t>& rows, const Context& context = {});

/// A cloud of n points with fields x, y, z of `type` and nothing else.
Cloud make_cloud(const double* xyz, std::size_t n, Scalar type = Scalar::float64);

}  // namespace rfsmooth::pipeline::io
