/// LAS, the format of airborne and survey scans, 1.0 to 1.4, point formats 0 to 10 (ASPRS LAS 1.4 R15).
///
/// A file is kept as it is: the bytes before the points, the points as rows, the bytes behind them.
/// Coordinates are int32 times a scale plus an offset. Writing changes in the header only what the points no
/// longer agree with: box, numbers of points, scale, and places of what moved.
#pragma once

#include <vector>

#include "pipeline/io/formats/las/las_header.h"
#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// Reads a LAS file. \throw Failure (input_unreadable) naming the byte, what was expected, what was found and
/// what to do; LAZ is refused so.
Cloud read_las(const Source& source, const Context& context);

/// Writes a LAS file. Fields behind those of the file become extra bytes with a name. \throw Failure (usage)
/// where the format has no room for them, or for so many points.
void write_las(const Cloud& cloud, Sink& sink, const Context& context);

/// What a LAS file holds besides its points, for `info`.
struct LasSummary {
  int minor = 0;  ///< version 1.minor
  int point_format = 0;
  std::array<double, 3> scale{}, offset{};
  std::vector<las::Record> records;  ///< VLRs, then EVLRs
};
/// Reads it from a cloud of format las.
LasSummary las_summary(const Cloud& cloud);

}  // namespace rfsmooth::pipeline::io
