/// What files of each format have room for, in one table. What conversion keeps, what it says is lost and
/// which encodings there are all come from it.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// What files of a format have room for.
struct Capacity {
  enum class Elements { none, polygons, all };  ///< polygons: the corners of faces, and no more of them
  enum class Grid { none, header, notes };      ///< header: words of its own; notes: lines like comments
  Format format;
  std::vector<Encoding> encodings;  ///< the first is taken where the cloud's own is none of them
  bool not_finite;                  ///< points whose coordinates are not
  Grid grid;                        ///< width x height, and the viewpoint
  Elements elements;                ///< beside the points
  /// Fields of the points that come first, in this order. The others stay in theirs.
  std::vector<std::size_t> (*first)(const Cloud& cloud);
  /// Whether there is room for a field of the points, with all that it holds.
  bool (*field)(const Cloud& cloud, std::size_t field, const Context& context);
};

/// Its row of the table.
const Capacity& capacity_of(Format format);

/// The encoding to write: `wanted`, or the cloud's own, or the target's nearest to it.
/// \throw Failure (usage) if `format` has no such encoding.
Encoding target_encoding(const Cloud& cloud, Format format, std::optional<Encoding> wanted);

/// Whether a field only fills rows up to their size (PCD's '_'): it is left out, and nothing is lost.
bool is_padding(const Field& field);

/// Whether a field of the points is x, y or z.
bool is_coordinate(const Cloud& cloud, std::size_t field);

/// The fields of the points that go along to `format`, in its order: those that it has room for, and the
/// coordinates, also where they lose digits.
std::vector<std::size_t> kept_fields(const Cloud& cloud, Format format, const Context& context);

/// The fields of an element beside the points that go along; none: not the element either.
std::optional<std::vector<std::size_t>> kept_of_element(const Table& element, Format from, Format to);

/// The length of a list field, if it is the same in every row and not zero. O(n).
std::optional<std::size_t> constant_length(const Table& table, std::size_t field, const Context& context);

}  // namespace rfsmooth::pipeline::io
