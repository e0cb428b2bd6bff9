/// Normals, and which part of the surface each point is of: for clouds that are looked at in pieces.
#pragma once

#include <vector>

#include <rfsmooth/mesh.h>
#include <rfsmooth/normals.h>

namespace rfsmooth::pipeline {

/// As estimate_normals. `part` (n): the same number for all rows of a part of the surface that was given its
/// side by itself, below n; kNone for rows that are not finite. \throw Failure.
NormalsReport normals_by_part(const double* xyz, std::size_t n, const NormalsOptions& options,
                              const Context& context, double* normals, std::vector<Index>& part);

}  // namespace rfsmooth::pipeline
