#include "rfs_mesh/connect/emst/emst.h"

#include "base/parallel.h"
#include "rfs_mesh/connect/emst/boruvka.h"

namespace rfsmooth::rfs_mesh {

namespace {

/// Nearest neighbours listed per point when the caller has no table. Measured on noisy surfaces: with 5 the
/// later rounds search more than the lists saved, with 8 the lists cost more than they save.
constexpr int kSeeds = 6;

void sort_by_length(std::vector<Edge>& edges, const Positions& points, const Context& context) {
  struct Keyed {
    double squared_length;
    Edge edge;
  };
  std::vector<Keyed> keyed(edges.size());
  for_each_index(context, edges.size(), [&](std::size_t e) {
    keyed[e] = {squared_distance(points[edges[e][0]], points[edges[e][1]]), edges[e]};
  });
  parallel_sort(context, keyed, [](const Keyed& a, const Keyed& b) {
    return a.squared_length != b.squared_length ? a.squared_length < b.squared_length : a.edge < b.edge;
  });
  for_each_index(context, edges.size(), [&](std::size_t e) { edges[e] = keyed[e].edge; });
}

}  // namespace

std::vector<Edge> emst(const SpatialIndex& index, const NeighborTable& nearest, const Context& context) {
  std::vector<Edge> edges = boruvka(index, nearest, context);
  sort_by_length(edges, index.points(), context);
  return edges;
}

std::vector<Edge> emst(const SpatialIndex& index, const Context& context) {
  std::vector<Edge> edges =
      boruvka(index, index.nearest(kSeeds, context), context);  // the table is gone here
  sort_by_length(edges, index.points(), context);
  return edges;
}

}  // namespace rfsmooth::rfs_mesh
