/// Which format a file is in, by its first lines.
#pragma once

#include "rfsmooth/pipeline/io/cloud.h"
#include "rfsmooth/pipeline/io/source.h"

namespace rfsmooth::pipeline::io {

/// \throw Failure (input_unreadable) if it is none of ours, saying what the file starts with.
Format detect_format(const Source& source, const Context& context);

}  // namespace rfsmooth::pipeline::io
