#include "base/parallel.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

Operator inverse_distance(const Mesh& mesh, const Context& context) {
  Operator op;
  const Adjacency& rows = mesh.one_ring;
  op.mass.resize(mesh.positions.size());
  op.weight.resize(rows.items.size());
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    double total = 0;
    for (Index k = rows.start[i]; k < rows.start[i + 1]; ++k) {
      const double length = (mesh.positions[i] - mesh.positions[rows.items[k]]).norm();
      op.weight[k] = length > 0 ? 1 / length : 0;
      total += op.weight[k];
    }
    op.mass[i] = total > 0 ? total : 1;
  });
  return op;
}

}  // namespace rfsmooth::smoothing
