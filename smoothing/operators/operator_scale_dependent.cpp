#include "base/parallel.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

Operator scale_dependent(const Mesh& mesh, const Context& context) {
  constexpr double kShortest = 1e-6;  // x mean edge: keeps 1 / |e| finite, far below any real edge
  Operator op;
  const Adjacency& rows = mesh.one_ring;
  const double h = length_unit(mesh, context);
  op.unit = h * h;
  op.mass.resize(mesh.positions.size());
  op.weight.resize(rows.items.size());
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    double total = 0;
    for (Index k = rows.start[i]; k < rows.start[i + 1]; ++k) {
      const double length =
          std::max(kShortest * h, (mesh.positions[i] - mesh.positions[rows.items[k]]).norm());
      op.weight[k] = 1 / length;
      total += length;
    }
    op.mass[i] = total > 0 ? 0.5 * total : h;
  });
  return op;
}

}  // namespace rfsmooth::smoothing
