/// Scans and truths as files: what `virtual_scanner` writes.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>

#include "clouds/scanner/scanner.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::clouds {

/// What a scanner delivers: x, y, z, intensity (float32) and, for several views, view (uint8). `organised`
/// keeps the rays that met nothing as NaN points of a columns x rows grid; else they are left out.
pipeline::io::Cloud measured_cloud(const std::vector<Return>& returns, const ScannerOptions& options,
                                   bool organised);

/// The same points where they truly are, in the same order, with `kind` (uint8): 1 surface, 2 mixed pixel, 3
/// stray (0 where nothing was hit).
pipeline::io::Cloud true_cloud(const std::vector<Return>& returns, const ScannerOptions& options,
                               bool organised);

/// Points without further fields, float32.
pipeline::io::Cloud plain_cloud(const Positions& points);

}  // namespace rfsmooth::clouds
