#include "rfsmooth/smoothing/operator.h"

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

void apply(const rfs_mesh::Adjacency& rows, const Operator& op, const Positions& x, Positions& y,
           const Context& context) {
  y.resize(x.size());
  const Index* const items = rows.items.data();
  const double* const weight = op.weight.empty() ? nullptr : op.weight.data();
  for_each_index(context, x.size(), [&](std::size_t i) {
    const Index begin = rows.start[i], end = rows.start[i + 1];
    Vector3d sum = Vector3d::Zero();
    if (weight == nullptr) {
      for (Index k = begin; k < end; ++k) sum += x[items[k]];
      sum = double(end - begin) * x[i] - sum;
    } else {
      for (Index k = begin; k < end; ++k) sum += weight[k] * (x[i] - x[items[k]]);
    }
    y[i] = sum / op.mass[i];
  });
}

Operator umbrella(const rfs_mesh::Mesh& mesh, const Context& context) {
  Operator op;
  op.mass.resize(mesh.positions.size());
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    op.mass[i] = double(std::max<std::size_t>(1, mesh.one_ring.degree(i)));
  });
  return op;
}

Operator inverse_distance(const rfs_mesh::Mesh& mesh, const Context& context) {
  Operator op;
  op.mass.resize(mesh.positions.size());
  op.weight.resize(mesh.one_ring.items.size());
  for_each_index(context, op.mass.size(), [&](std::size_t i) {
    double total = 0;
    for (Index k = mesh.one_ring.start[i]; k < mesh.one_ring.start[i + 1]; ++k) {
      const double length = (mesh.positions[i] - mesh.positions[mesh.one_ring.items[k]]).norm();
      op.weight[k] = length > 0 ? 1 / length : 0;
      total += op.weight[k];
    }
    op.mass[i] = total > 0 ? total : 1;
  });
  return op;
}

}  // namespace rfsmooth::smoothing
