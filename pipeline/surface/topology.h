/// What kind of surface a triangle mesh is: its pieces, rims and handles.
///
/// Vertices count as far as faces use them. Per piece Euler's formula V - E + F = 2 - 2 g - b gives the genus
/// g from the b rims of an orientable manifold; `genus` is the sum over the pieces and means nothing where
/// edges are crowded or vertices pinched.
#pragma once

#include <cstddef>
#include <vector>

#include <rfsmooth/reconstruct.h>

namespace rfsmooth::pipeline {

/// Of faces over n vertices. Precondition: corners are distinct and < n. O(m log m), one thread.
Topology topology(std::size_t n, const std::vector<Face>& faces);

}  // namespace rfsmooth::pipeline
