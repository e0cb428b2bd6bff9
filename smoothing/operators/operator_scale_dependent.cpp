#include <algorithm>

#include "base/parallel.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

Operator scale_dependent(const Mesh& mesh, const Context& context) {
  constexpr double kShortestEdge = 1e-6;  // x h: shorter edges count as this long; keeps 1 / |e| finite
  Operator op;
  const Adjacency& rows = mesh.one_ring;
  const double h = length_unit(mesh, context);
  op.unit = h * h;
  op.mass.resize(mesh.positions.size());
  op.weight.resize(rows.items.size());
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    double edge_sum = 0;  // E
    for (Index k = rows.start[i]; k < rows.start[i + 1]; ++k) {
      const double length =
          std::max(kShortestEdge * h, (mesh.positions[i] - mesh.positions[rows.items[k]]).norm());
      op.weight[k] = 1 / length;
      edge_sum += length;
    }
    op.mass[i] = edge_sum > 0 ? 0.5 * edge_sum : h;  // without neighbours: any m > 0
  });
  return op;
}

}  // namespace rfsmooth::smoothing
