/// Rows of values as in the file: a PLY element, or the points of a PCD, XYZ or OFF file.
///
/// Binary rows are kept as bytes (always little-endian), ascii rows as their text, so that unchanged values
/// are written back bit for bit. Rows have a fixed size unless they hold lists or are text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "pipeline/io/table/bytes.h"
#include "pipeline/io/table/field.h"
#include "pipeline/io/table/text.h"

namespace rfsmooth::pipeline::io {

/// Blank or comment lines of a text table before row `row`, verbatim with their line ends.
struct Interlude {
  std::size_t row;
  std::string text;
};

/// An element of a file: rows of fields.
struct Table {
  std::string name;           ///< "vertex", "face", ...
  std::vector<Field> fields;  ///< in file order; names may repeat
  std::size_t count = 0;      ///< rows

  bool text = false;    ///< rows are lines of text, with their line ends
  bool ragged = false;  ///< text rows may hold more values than the fields name (OFF faces)
  Separators separators = Separators::space;  ///< of text rows
  std::vector<Interlude> interludes;          ///< of text rows, ascending by row

  Bytes data;                        ///< all rows, one after the other
  std::vector<std::uint64_t> start;  ///< count + 1 offsets into data; empty if rows have a fixed size

  bool has_lists() const;
  /// Bytes of a row of fixed size. \throw std::logic_error if a field is a list.
  std::size_t row_size() const { return offset_of(fields.size()); }
  /// Where a field begins in a row. \throw std::logic_error if one before it is a list.
  std::size_t offset_of(std::size_t field) const;
  std::string_view row(std::size_t i) const;
};

/// The values of the plain fields with indices `which`: count x which.size(), row-major, as doubles.
/// Parallel. \throw std::invalid_argument if a field is not plain.
std::vector<double> gather(const Table& table, const std::vector<std::size_t>& which, const Context& context);

/// The values of a list or array field: those of row i are values[start[i]] .. values[start[i + 1] - 1].
struct Lists {
  std::vector<std::uint64_t> start;  ///< count + 1
  std::vector<double> values;
};
/// The values of `field` in every row.
Lists gather_lists(const Table& table, std::size_t field, const Context& context);

/// How many values `field` has in every row. Parallel.
std::vector<std::size_t> list_lengths(const Table& table, std::size_t field, const Context& context);

/// Sets the values of plain fields, each in its own type. A value that equals the present one (or both are
/// NaN) keeps its bytes or its text. New text has the fewest digits that round-trip.
void scatter(Table& table, const std::vector<std::size_t>& which, const double* values,
             const Context& context);

/// Appends a plain field with one value per row. A cell of text is in quotes where the one before it is.
void append_field(Table& table, const Field& field, const double* values, const Context& context);

/// Writes rows of text anew as words with one blank between them: an empty cell becomes "nan", a quoted one
/// loses its quotes, tabs and CRs within a row are blanks. Does nothing to other words and to bytes.
void make_words(Table& table, const Context& context);

/// Turns the rows into text of cells. An empty one stays empty.
void make_cells(Table& table, Separators separators, const Context& context);

/// Keeps the rows `which` in that order. O(rows and interludes).
void select(Table& table, const std::vector<std::size_t>& which);

/// The fields that name points by their index: those of faces (vertex_indices, vertex_index) and of edges
/// (vertex1, vertex2).
std::vector<std::size_t> fields_of_indices(const Table& table);

/// Keeps the rows of which every value of the fields `which`, plain or lists, has a new number, and writes
/// that in its place; all other bytes stay. `number`: the new one of each old one; kNone: it has none, as
/// those beyond have not. Values below 0 name no point and stay (PLY's tristrips have -1 between strips).
/// Strips of triangles (element tristrips) are cut where a point has none: the other triangles stay, and
/// their sides.
void renumber(Table& table, const std::vector<std::size_t>& which, const std::vector<Index>& number,
              const Context& context);

/// Keeps the fields `which`, in that order. Text rows are rewritten, values separated by a blank.
void project(Table& table, const std::vector<std::size_t>& which, const Context& context);

/// Turns the array field `which` into a list, with each row's count in front.
void insert_list_counts(Table& table, std::size_t which, Scalar count_type, const Context& context);
/// Turns the list field `which`, whose length is `count` in every row, back into an array.
void remove_list_counts(Table& table, std::size_t which, std::size_t count, const Context& context);

/// Whether float32 holds all the digits that the text of the plain fields `which` has.
bool text_fits_float32(const Table& table, const std::vector<std::size_t>& which, const Context& context);

/// Turns the rows into text, values separated by a blank. Does nothing if they are text. Ragged values are
/// dropped.
void make_text(Table& table, const Context& context);
/// Turns the rows into bytes in the fields' types. Does nothing if they are bytes. Ragged values are dropped.
void make_binary(Table& table, const Context& context);

}  // namespace rfsmooth::pipeline::io
