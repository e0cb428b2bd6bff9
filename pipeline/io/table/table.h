/// Rows of values as the file has them: a PLY element, or the points of a PCD, XYZ or OFF file.
///
/// Binary rows are kept as bytes (little-endian whatever the file was), ascii rows as their text, so that
/// what nobody touched goes back bit for bit. Rows have a fixed size unless they hold lists or are text.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>

#include "pipeline/io/table/bytes.h"
#include "pipeline/io/table/field.h"
#include "pipeline/io/table/text.h"

namespace rfsmooth::pipeline::io {

/// Blank or comment lines of a text table, verbatim with their line ends, that stand before row `row`.
struct Interlude {
  std::size_t row;
  std::string text;
};

/// An element of a file: rows of fields, kept as the file has them.
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
  std::size_t row_size() const;
  std::string_view row(std::size_t i) const;
};

/// The values of plain fields `which` (their indices), count x which.size(), row-major, as doubles (parsed
/// from the text where rows are text). Parallel. \throw std::invalid_argument if a field is not plain.
std::vector<double> gather(const Table& table, const std::vector<std::size_t>& which, const Context& context);

/// The values of a list field (or of an array), row after row: row i has values[start[i]] .. values[start[i +
/// 1]].
struct Lists {
  std::vector<std::uint64_t> start;  ///< count + 1
  std::vector<double> values;
};
/// Reads the list `field` of every row.
Lists gather_lists(const Table& table, std::size_t field, const Context& context);

/// Writes values back into plain fields, each in its own type; a value that equals the present one (or both
/// are NaN) keeps its bytes or its text. Text gets the fewest digits that round-trip.
void scatter(Table& table, const std::vector<std::size_t>& which, const double* values,
             const Context& context);

/// Appends a plain field with one value per row.
void append_field(Table& table, const Field& field, const double* values, const Context& context);

/// Keeps the rows `which` in that order.
void select(Table& table, const std::vector<std::size_t>& which);

/// Keeps the fields `which`, in that order; text rows are written anew, values separated by a blank.
void project(Table& table, const std::vector<std::size_t>& which, const Context& context);

/// Turns the array field `which` into a list, each row's count in front, and a list whose length is `count`
/// in every row back into an array.
void insert_list_counts(Table& table, std::size_t which, Scalar count_type, const Context& context);
/// See `insert_list_counts`.
void remove_list_counts(Table& table, std::size_t which, std::size_t count, const Context& context);

/// Whether float32 holds all the digits that the text of the plain fields `which` has.
bool text_fits_float32(const Table& table, const std::vector<std::size_t>& which, const Context& context);

/// The same rows as text, values separated by a blank, or as bytes in the fields' types.
/// Both leave a table alone that is so already. Ragged values are dropped.
void make_text(Table& table, const Context& context);
/// See `make_text`.
void make_binary(Table& table, const Context& context);

}  // namespace rfsmooth::pipeline::io
