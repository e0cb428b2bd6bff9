/// PLY, the Stanford polygon format: ascii, binary little- and big-endian; any elements, lists anywhere.
#pragma once

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// Reads a PLY file. \throw Failure (input_unreadable) naming line or byte, what was expected and what was
/// found.
Cloud read_ply(const Source& source, const Context& context);

/// Reads the header alone: elements without their rows. Leaves `lines` behind end_header.
Cloud read_ply_header(HeaderLines& lines);

/// Whether it is the first line of a PLY file, which may end in blanks.
bool is_ply_line(std::string_view line);

/// The header of `cloud` as we write it, in `encoding`.
std::string ply_header(const Cloud& cloud, Encoding encoding);

/// Writes a PLY file; an encoding other than the cloud's converts the rows on the way.
void write_ply(const Cloud& cloud, Encoding encoding, Sink& sink, const Context& context);

/// Finds the element of the points, the first that is called 'vertex'. \throw Failure through `source` if
/// there is none, naming the elements there are.
void find_vertex(Cloud& cloud, const Source& source);

/// Finds x, y, z among the points' fields: plain, lower case before upper case, the first of several.
/// \throw Failure through `source` if one is missing, naming the fields there are; warns of several.
void find_coordinates(Cloud& cloud, const Source& source, const Context& context);

/// Warns of what stands behind the last row that the header counts, but for blanks, and comments in text. It
/// stays as it is.
void warn_of_tail(const Cloud& cloud, const Source& source, const Context& context);

}  // namespace rfsmooth::pipeline::io
