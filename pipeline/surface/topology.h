/// The topology of a triangle mesh: its pieces, rims and handles.
///
/// Only vertices with faces count. For each piece Euler's formula V - E + F = 2 - 2 g - b gives the genus g
/// of an orientable manifold with b rims. `genus` is the sum over the pieces; it has no meaning if edges are
/// crowded or vertices pinched.
#pragma once

#include <cstddef>
#include <vector>

#include <rfsmooth/reconstruct.h>

#include "base/disjoint_sets.h"

namespace rfsmooth::pipeline {

/// The n vertices by the pieces that faces make of them, which hang together through vertices. O(m), one
/// thread.
DisjointSets<Index> pieces_of(std::size_t n, const std::vector<Face>& faces);

/// The topology of faces over n vertices. Precondition: corners are distinct and < n. O(m log m), one thread.
Topology topology(std::size_t n, const std::vector<Face>& faces);

}  // namespace rfsmooth::pipeline
