/// Peer: the Euclidean minimum spanning tree by CGAL's Delaunay triangulation and Kruskal's rule (GPL, so
/// only in tests and benchmarks). Plain arrays: CGAL's headers stay in the .cpp.
#pragma once

#include <cstddef>

namespace rfsmooth::bench::peers {

/// Total length of the EMST of n x 3 coordinates. In parallel: CGAL's Parallel_tag with its lock grid, and a
/// parallel sort of the edges; give it the number of threads by running it in an arena of that many.
double emst_length_cgal(const double* xyz, std::size_t n, bool parallel);

}  // namespace rfsmooth::bench::peers
