/// Comments of a file in the words of another format.
#pragma once

#include <string_view>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// What PCD says where the scanner's place is not known.
inline constexpr std::string_view kNoViewpoint = "0 0 0 1 0 0 0";

/// Makes the notes, and comments between rows of text, those of a file of format `to`. PLY's obj_info lines
/// of grid (num_cols, num_rows) and viewpoint become the cloud's width x height and viewpoint, and back where
/// `to` has no other place for these.
void rewrite_notes(Cloud& cloud, Format from, Format to);

}  // namespace rfsmooth::pipeline::io
