/// A cloud (or mesh) file in memory, lossless: what is read and not changed is written back byte for byte.
///
/// Only coordinates, and fields a caller adds or removes, change. Everything else - field order, types and
/// names, rows with NaN, other PLY elements, comments, width x height, viewpoint - travels along.
/// Not thread-safe for writing; distinct clouds are independent.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/cloud_file.h>
#include <rfsmooth/context.h>
#include <rfsmooth/result.h>

#include "pipeline/io/table/table.h"

namespace rfsmooth::pipeline::io {

using rfsmooth::Encoding;
using rfsmooth::Format;

std::string_view name_of(Format format);      ///< "ply", "pcd", "xyz", "off", "las"
std::string_view name_of(Encoding encoding);  ///< as PLY and PCD headers write them ("binary_little_endian")

/// A comment or obj_info line of a header, without its line end, and where it stands: before property `field`
/// of element `element`; field 0 = before the element's own line, so that property k is field k + 1. Element
/// kBeforeFormat: before PLY's format line.
struct Note {
  static constexpr std::size_t kBeforeFormat = std::size_t(-1);
  std::string line;
  std::size_t element = 0;
  std::size_t field = 0;
};

/// What an XYZ file says before its first point, besides comments.
struct XyzStyle {
  bool counted = false;              ///< a line with the number of points (.pts)
  std::optional<std::string> names;  ///< a line that names the columns: what it starts with ("//", "# ", "")
  char separator = ' ';              ///< between those names
};

/// A file in memory: every element and field, also those nobody here understands.
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
  std::string original_header;  ///< verbatim
  std::string
      original_canonical;  ///< what we would have written for it: as long as that stays, so does the original
  std::string tail;        ///< bytes after the last row

  Table& points() { return elements[vertex]; }
  const Table& points() const { return elements[vertex]; }
  std::size_t size() const { return points().count; }
  bool organised() const { return height > 1; }

  /// The element of that name, or null.
  const Table* element(std::string_view name) const;
};

/// The coordinates, n x 3 row-major, as doubles (of text: what the text says, whatever the type). O(n),
/// parallel.
std::vector<double> positions(const Cloud& cloud, const Context& context = {});

/// Writes n x 3 coordinates back, each in its own type, floats rounded to nearest. A coordinate equal to the
/// present one keeps its bytes or text. Integer coordinates are rounded to whole numbers and a warning is
/// logged. Scaled ones (LAS) are rounded to their scale; a warning is logged for what is beyond their range.
void set_positions(Cloud& cloud, const double* xyz, const Context& context = {});

/// The field of the points with that name (the first of several), or none.
std::optional<std::size_t> find_field(const Cloud& cloud, std::string_view name);

/// A plain field of the points, one double per point. \throw std::invalid_argument if it is a list or an
/// array.
std::vector<double> field_values(const Cloud& cloud, std::size_t field, const Context& context = {});

/// Writes a field of the points, the one way in which any stage adds one (displacement, outlier, normals):
///
/// - none of that name: it is appended behind the points' last field, as `type`; every other byte stays.
/// - one of that name (the first of several): its values are replaced in place, in its own type.
///
/// \throw Failure (usage) if the present one cannot take the values: `check_field` says so beforehand.
void set_field(Cloud& cloud, const std::string& name, Scalar type, const std::vector<double>& values,
               const Context& context = {});

/// Refuses what `set_field` could not do: the field of that name is a list or an array, or holds whole
/// numbers where `type` has fractions. \throw Failure (usage) naming field and type.
void check_field(const Cloud& cloud, const std::string& name, Scalar type);

/// Keeps the points `rows` (ascending or in any order); the result is unorganised unless all are kept in
/// order. Other elements that name points by index (lists called vertex_indices or vertex_index, vertex1,
/// vertex2) would be wrong and are dropped with a warning.
void select_points(Cloud& cloud, const std::vector<std::size_t>& rows, const Context& context = {});

/// A cloud of n points with fields x, y, z of `type` and nothing else.
Cloud make_cloud(const double* xyz, std::size_t n, Scalar type = Scalar::float64);

}  // namespace rfsmooth::pipeline::io
