/// Peers of the spatial index: the k nearest of every point by FLANN and by nanoflann. Plain arrays: their
/// headers stay in the .cpp files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>

namespace rfsmooth::bench::peers {

/// An index over n x 3 coordinates that stay where they are.
class NeighborIndex {
 public:
  virtual ~NeighborIndex() = default;
  /// The k nearest (the point itself among them) of the points [begin, end), into rows of k.
  virtual void nearest(std::size_t begin, std::size_t end, int k, std::uint32_t* rows) const = 0;
};

std::unique_ptr<NeighborIndex> flann_index(const double* xyz, std::size_t n);
std::unique_ptr<NeighborIndex> nanoflann_index(const double* xyz, std::size_t n);

}  // namespace rfsmooth::bench::peers
