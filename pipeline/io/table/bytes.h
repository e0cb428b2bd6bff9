/// A growable buffer whose new bytes are not zeroed first: files are read straight into it.
#pragma once

#include <vector>

#include "base/unfilled.h"

namespace rfsmooth::pipeline::io {

/// Bytes that are not cleared first.
using Bytes = std::vector<char, Unfilled<char>>;

}  // namespace rfsmooth::pipeline::io
