/// Conversion between formats: keeps what the target has room for (capacity.h) and names the rest.
#pragma once

#include <string>
#include <vector>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// Whether the cloud's rows can be written as they are: the format is the same, for PLY no field of the
/// points is of a type that it lacks, and for OFF, whose columns have no names, none stands out of order or
/// is unknown to OFF.
bool is_writable_as_is(const Cloud& cloud, Format format);

/// What writing the cloud in this way would lose, in words; empty if nothing. Not counted: the type names of
/// a text without types (XYZ, OFF), padding fields ('_') and the bytes behind the last row.
std::vector<std::string> what_is_lost(const Cloud& cloud, Format format, Encoding encoding,
                                      const Context& context);

/// The same before the points get new coordinates and the fields `added`, plain ones. Not counted: digits of
/// the coordinates, which new ones may not have.
std::vector<std::string> what_will_be_lost(const Cloud& cloud, const std::vector<Field>& added, Format format,
                                           Encoding encoding, const Context& context);

/// The same of a mesh that is still to be made: x, y, z and triangles.
std::vector<std::string> lost_of_triangles(Format format);

/// The same of x, y, z and edges.
std::vector<std::string> lost_of_edges(Format format);

/// Refuses to lose anything. \throw Failure (usage) naming `losses`, unless there are none.
void need_no_losses(const std::vector<std::string>& losses, Format format, Encoding encoding);

/// The cloud as one of `format`, without what is lost. Arrays (PCD's COUNT) become PLY lists and back; width
/// x height and viewpoint become obj_info lines (num_cols, num_rows, viewpoint) and back; comments stay
/// comments. To and from LAS by way of a cloud of plain numbers (las_plain.h, las_pack.h).
Cloud convert(const Cloud& cloud, Format format, const Context& context);

/// The cloud, of format XYZ, as a table as other programs read it: a line of names, no number of points, and
/// `separators` between cells.
Cloud as_cells(Cloud cloud, Separators separators, const Context& context);

}  // namespace rfsmooth::pipeline::io
