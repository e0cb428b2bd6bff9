/// Points that stand for all of a cloud, where looking at each costs too much. Thread safe: no state is kept.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <rfsmooth/mesh.h>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::rfs_mesh {

/// Those of n points, ascending: `most` of them at even steps, or all if there are no more. In Morton order
/// (points.h) they are spread evenly over the cloud.
inline std::vector<Index> sample_rows(std::size_t n, std::size_t most = kSampleOfCloud) {
  std::vector<Index> rows(std::min(n, most));
  for (std::size_t s = 0; s < rows.size(); ++s) rows[s] = Index(s * n / rows.size());
  return rows;
}

/// The points, or whatever it is, in these rows: `most` of all at even steps.
template <class T>
std::vector<T> sample(const std::vector<T>& all, std::size_t most) {
  std::vector<T> some;
  for (const Index i : sample_rows(all.size(), most)) some.push_back(all[i]);
  return some;
}

/// Those rows of `all` (n x 3). Parallel.
inline Positions at_rows(const Positions& all, const std::vector<Index>& rows, const Context& context) {
  Positions at(rows.size());
  for_each_index(context, rows.size(), [&](std::size_t s) { at[s] = all[rows[s]]; });
  return at;
}

}  // namespace rfsmooth::rfs_mesh
