#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/smoothing/operator.h"

namespace rfsmooth::smoothing {

Operator umbrella(const rfs_mesh::Mesh& mesh, const Context& context) {
  Operator op;
  op.mass.resize(mesh.positions.size());
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    op.mass[i] = double(std::max<std::size_t>(1, mesh.one_ring.degree(i)));
  });
  return op;
}

}  // namespace rfsmooth::smoothing
