/// A growable buffer that does not initialise new bytes, so that files are read straight into it.
#pragma once

#include <vector>

#include "base/unfilled.h"

namespace rfsmooth::pipeline::io {

/// Bytes; resize() leaves new ones indeterminate.
using Bytes = std::vector<char, Unfilled<char>>;

}  // namespace rfsmooth::pipeline::io
