/// Places of a cloud at which its scatter is measured again and again, in ever other neighbourhoods and
/// windows (scatter.h), while they stay or move a little.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include <rfsmooth/context.h>

#include "rfs_mesh/fit/scatter.h"
#include "rfs_mesh/search/kept_neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The places, and the neighbours that were found around each, from which the next are found. Not for several
/// threads at once; the fits run in parallel and are deterministic.
class Places {
 public:
  /// Keeps references to index and context. \param at world units. \param most neighbours to keep
  /// (KeptNeighbors).
  Places(const SpatialIndex& index, Positions at, std::size_t most, const Context& context);
  Places(const SpatialIndex& index, Positions at, std::size_t most, Context&& context) = delete;

  const SpatialIndex& index() const { return index_; }
  const Context& context() const { return context_; }
  const Positions& at() const { return at_; }
  std::size_t size() const { return at_.size(); }

  /// A fit to the m points nearest to each place, with a window of sigma; 0: without.
  std::vector<Scatter> fits(std::size_t m, double sigma = 0);
  /// With m of each.
  std::vector<Scatter> fits(const std::vector<std::size_t>& m, double sigma = 0);
  /// With m and sigma of each.
  std::vector<Scatter> fits(const std::vector<std::size_t>& m, const std::vector<double>& sigma);

  /// Fits again where `wanted` is not 0. \param all a fit of each place
  void renew(std::vector<Scatter>& all, const std::vector<char>& wanted, const std::vector<std::size_t>& m,
             const std::vector<double>& sigma);

  /// Each place goes to where its fit has the surface.
  void move_to_feet(const std::vector<Scatter>& fits);
  /// As many as there are.
  void move_to(Positions at) { at_ = std::move(at); }

 private:
  const SpatialIndex& index_;
  const Context& context_;
  Positions at_;
  std::vector<KeptNeighbors> kept_;
};

}  // namespace rfsmooth::rfs_mesh
