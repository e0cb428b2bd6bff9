/// XYZ, plain columns of numbers: blanks, tabs, commas or semicolons between them; comments ('#', '//') and
/// blank lines anywhere; a line of column names or a number of points (.pts) first. Columns are doubles;
/// without names the first three are x, y, z and column k is "column_k", but three columns in a row that hold
/// unit vectors are the normals nx, ny, nz. Between commas, semicolons or tabs a cell may be empty (NaN) or
/// in quotes. A name may have a unit: "x [m]" is x. Coordinates may have the names of other programs.
#pragma once

#include <array>
#include <optional>

#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"
#include "pipeline/io/table/rows.h"

namespace rfsmooth::pipeline::io {

/// Reads an XYZ file. \throw Failure (input_unreadable) naming the line, what was expected and what was
/// found.
Cloud read_xyz(const Source& source, const Context& context);

/// A line that may name the columns.
struct XyzNames {
  std::string prefix;  ///< a comment sign and blanks, or nothing
  std::string line;    ///< the rest
  bool comment;
  std::size_t number;  ///< of the line, from 1
  std::size_t note;    ///< its place in the cloud's notes
};

/// Reads up to the first point; the comments become notes. \return the lines that name x, y and z, of which
/// the last one may be no comment. \throw Failure if a line ends in CR alone.
std::vector<XyzNames> read_xyz_beginning(TextCursor& cursor, Cloud& cloud);

/// The names of so many columns as the file has them, and their style; empty if there are none. A comment
/// that names something else is one. \throw Failure if a line of names does not match the columns.
std::vector<std::string> take_xyz_names(const std::vector<XyzNames>& lines, std::size_t columns,
                                        Separators separators, const Source& source, Cloud& cloud);

/// Where x, y and z are among names of columns that call them otherwise: Easting, Northing and Height, say.
std::optional<std::array<std::size_t, 3>> xyz_coordinates(const std::vector<std::string>& names);

/// The name in a cell of names, without quotes and unit, a blank inside it as '_'.
std::string name_in_cell(std::string_view cell);

/// What stands before the first point, as we write it.
std::string xyz_header(const Cloud& cloud);

/// Writes the whole file.
void write_xyz(const Cloud& cloud, Sink& sink, const Context& context);

}  // namespace rfsmooth::pipeline::io
