/// XYZ, plain columns of numbers: blanks, tabs, commas or semicolons between them; comments ('#', '//') and
/// blank lines anywhere; a line of column names or a number of points (.pts) first. Columns are doubles;
/// without names the first three are x, y, z and column k is "column_k", but three columns in a row that hold
/// unit vectors are the normals nx, ny, nz.
#pragma once

#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// Reads an XYZ file. \throw Failure (input_unreadable) naming the line, what was expected and what was
/// found.
Cloud read_xyz(const Source& source, const Context& context);

/// What stands before the first point, as we write it.
std::string xyz_header(const Cloud& cloud);

/// Writes the whole file.
void write_xyz(const Cloud& cloud, Sink& sink, const Context& context);

}  // namespace rfsmooth::pipeline::io
