#include "smoothing/operators/operator.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "rfs_mesh/measure.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

void apply(const Adjacency& rows, const Operator& op, const Positions& x, Positions& y,
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
    y[i] = (1 / op.mass[i]) * sum;
  });
}

std::vector<double> weight_sums(const Adjacency& rows, const Operator& op, const Context& context) {
  std::vector<double> sums(rows.size());
  for_each_index(context, sums.size(), [&](std::size_t i) {
    if (op.weight.empty()) {
      sums[i] = double(rows.degree(i));
      return;
    }
    for (Index k = rows.start[i]; k < rows.start[i + 1]; ++k) sums[i] += std::abs(op.weight[k]);
  });
  return sums;
}

double length_unit(const Mesh& mesh, const Context& context) {
  if (mesh.closing == kNone) {
    const double h = rfs_mesh::mean_edge_length(mesh, context);
    return h > 0 ? h : 1;
  }
  using Sum = Eigen::Vector2d;  // of lengths, and how many
  const Sum sum = sum_over(context, std::min<std::size_t>(mesh.closing, mesh.positions.size()),
                           Sum(Sum::Zero()), [&](std::size_t i) {
                             Sum own = Sum::Zero();
                             for (const Index j : mesh.one_ring[i])
                               if (j < mesh.closing)
                                 own += Sum((mesh.positions[i] - mesh.positions[j]).norm(), 1);
                             return own;
                           });
  return sum[0] > 0 ? sum[0] / sum[1] : 1;
}

Operator umbrella(const Adjacency& rows, const Context& context) {
  Operator op;
  op.mass.resize(rows.size());
  for_each_index(context, op.mass.size(),
                 [&](std::size_t i) { op.mass[i] = double(std::max<std::size_t>(1, rows.degree(i))); });
  return op;
}

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

double thin_plate_energy(const Adjacency& rows, const Operator& op, const Positions& x,
                         const Context& context) {
  Positions first;
  apply(rows, op, x, first, context);
  return sum_over(context, x.size(), 0.0, [&](std::size_t i) { return op.mass[i] * first[i].squaredNorm(); });
}

OperatorSource::OperatorSource(OperatorKind kind, bool frozen, Scheme scheme)
    : kind_(kind), frozen_(frozen), scheme_(scheme) {}

const Operator& OperatorSource::on(const Mesh& mesh, const Context& context) {
  const bool fixed_weights = frozen_ || kind_ == OperatorKind::umbrella;
  if (ready_ && fixed_weights) return op_;
  if (kind_ == OperatorKind::umbrella) {
    op_ = umbrella(mesh.one_ring, context);
  } else if (kind_ == OperatorKind::inverse_distance) {
    op_ = inverse_distance(mesh, context);
  } else if (kind_ == OperatorKind::scale_dependent) {
    op_ = scale_dependent(mesh, context);
  } else if (kind_ == OperatorKind::tufted) {
    op_ = tufted(mesh, context);
  } else {
    if (!ready_) faces_ = vertex_faces(mesh, context);
    op_ = curvature(mesh, faces_, context, scheme_);
    if (kind_ == OperatorKind::curvature_normalised) op_ = normalised(mesh.one_ring, std::move(op_), context);
  }
  ready_ = true;
  return op_;
}

void OperatorSource::connectivity_changed() {
  ready_ = false;
}

}  // namespace rfsmooth::smoothing
