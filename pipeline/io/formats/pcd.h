/// PCD, PCL's point cloud format: ascii, binary, binary_compressed; any fields, COUNT, width x height,
/// viewpoint.
#pragma once

#include "pipeline/io/formats/header_lines.h"
#include "pipeline/io/stream/sink.h"
#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// Reads a PCD file. \throw Failure (input_unreadable) naming line or byte, what was expected and what was
/// found.
Cloud read_pcd(const Source& source, const Context& context);

/// Reads the header alone. Leaves `lines` behind the DATA line.
Cloud read_pcd_header(HeaderLines& lines);

/// The header of `cloud` as we write it, in `encoding` (binary_little_endian is PCD's "binary").
std::string pcd_header(const Cloud& cloud, Encoding encoding);

/// Writes a PCD file; an encoding other than the cloud's converts the rows on the way.
/// \throw Failure (usage) for binary_compressed of 4 GiB or more, which the format cannot say.
void write_pcd(const Cloud& cloud, Encoding encoding, Sink& sink, const Context& context);

}  // namespace rfsmooth::pipeline::io
