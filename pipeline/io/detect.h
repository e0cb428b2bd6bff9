/// Detects the format of a file by its first lines.
#pragma once

#include "pipeline/io/stream/source.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// \throw Failure (input_unreadable) if it is none of ours; the message quotes the start of the file.
Format detect_format(const Source& source, const Context& context);

}  // namespace rfsmooth::pipeline::io
