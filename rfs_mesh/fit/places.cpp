#include "rfs_mesh/fit/places.h"

#include <utility>

#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

Places::Places(const SpatialIndex& index, Positions at, std::size_t most, const Context& context)
    : index_(index), context_(context), at_(std::move(at)), kept_(at_.size(), KeptNeighbors(most)) {}

std::vector<Scatter> Places::fits(std::size_t m, double sigma) {
  return fits(std::vector<std::size_t>(size(), m), sigma);
}

std::vector<Scatter> Places::fits(const std::vector<std::size_t>& m, double sigma) {
  return fits(m, std::vector<double>(size(), sigma));
}

std::vector<Scatter> Places::fits(const std::vector<std::size_t>& m, const std::vector<double>& sigma) {
  std::vector<Scatter> all(size());
  renew(all, std::vector<char>(size(), 1), m, sigma);
  return all;
}

void Places::renew(std::vector<Scatter>& all, const std::vector<char>& wanted,
                   const std::vector<std::size_t>& m, const std::vector<double>& sigma) {
  for_blocks(context_, size(), 16, [&](std::size_t begin, std::size_t end) {
    ScatterFit fit;
    for (std::size_t s = begin; s < end; ++s)
      if (wanted[s] != 0) all[s] = fit(index_, at_[s], m[s], sigma[s], kept_[s]);
  });
}

void Places::move_to_feet(const std::vector<Scatter>& fits) {
  for (std::size_t s = 0; s < size(); ++s) at_[s] = fits[s].foot;
}

}  // namespace rfsmooth::rfs_mesh
