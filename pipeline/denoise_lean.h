/// `denoise` (rfsmooth/denoise.h) for callers who can make the coordinates again, as from the bytes of a
/// file: nobody holds them while the cloud is connected and smoothed. Thread safe on distinct arrays.
#pragma once

#include <functional>
#include <vector>

#include <rfsmooth/denoise.h>

namespace rfsmooth::pipeline {

/// What `denoise` makes of the rows of `xyz` (n x 3), with 24 bytes a point less. \param again returns `xyz`
/// as it is now. On an error `xyz` may be empty.
Result<DenoiseReport> denoise_lean(std::vector<double>& xyz,
                                   const std::function<std::vector<double>()>& again,
                                   const DenoiseOptions& options, const Context& context,
                                   const std::vector<double>& strength = {});

}  // namespace rfsmooth::pipeline
