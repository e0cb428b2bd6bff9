#include "base/parallel.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

Operator umbrella(const Mesh& mesh, const Context& context) {
  return umbrella(mesh.one_ring, context);
}

Operator umbrella(const Adjacency& rows, const Context& context) {
  Operator op;
  op.mass.resize(rows.size());
  for_each_index(context, op.mass.size(),
                 [&](std::size_t i) { op.mass[i] = double(std::max<std::size_t>(1, rows.degree(i))); });
  return op;
}

}  // namespace rfsmooth::smoothing
