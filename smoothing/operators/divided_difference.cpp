#include "smoothing/operators/divided_difference.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "base/parallel.h"
#include "rfs_mesh/corners.h"
#include "smoothing/operators/operator.h"
#include "smoothing/operators/surface.h"

namespace rfsmooth::smoothing {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// The neighbours of i in the order in which its faces go around, and whether they close; empty if they do
/// not go around exactly once or leave a neighbour out.
struct Fan {
  std::vector<Index> order;
  bool closed = false;
};

Fan fan_of(const Mesh& mesh, const Adjacency& faces, Index i) {
  std::vector<rfs_mesh::OtherCorners> sides;
  for (const Index f : faces[i]) sides.push_back(rfs_mesh::other_corners(mesh.faces[f], i));
  Fan fan;
  const auto row = mesh.one_ring[i];
  if (sides.empty()) return fan;
  Index start = row[0];
  int ends = 0;
  for (const Index j : row) {
    const auto uses =
        std::count_if(sides.begin(), sides.end(), [j](const auto& s) { return s.next == j || s.last == j; });
    if (uses == 0 || uses > 2) return fan;
    if (uses == 1 && ends++ == 0) start = j;
  }
  if (ends != 0 && ends != 2) return fan;
  std::vector<char> used(sides.size(), 0);
  fan.order.push_back(start);
  for (std::size_t step = 0; step < sides.size(); ++step) {
    for (std::size_t s = 0; s < sides.size(); ++s) {
      if (used[s] != 0) continue;
      const Index at = fan.order.back();
      if (sides[s].next != at && sides[s].last != at) continue;
      used[s] = 1;
      fan.order.push_back(sides[s].next == at ? sides[s].last : sides[s].next);
      break;
    }
  }
  fan.closed = ends == 0;
  if (fan.closed) {
    if (fan.order.back() != start) return {};
    fan.order.pop_back();
  }
  if (fan.order.size() != row.size()) return {};
  return fan;
}

/// (u, v) of each neighbour in row order; empty where the vertex has no tangent plane.
std::vector<Vector2d> chart_of(const Mesh& mesh, const Adjacency& faces, const Vector3d& n, Index i,
                               Chart kind) {
  const Positions& x = mesh.positions;
  const auto row = mesh.one_ring[i];
  std::vector<Vector2d> chart;
  const Fan fan = kind == Chart::tangent ? Fan{} : fan_of(mesh, faces, i);
  if (fan.order.empty()) {
    if (n == Vector3d::Zero()) return chart;
    const Vector3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
    for (const Index j : row) chart.emplace_back(e1.dot(x[j] - x[i]), e2.dot(x[j] - x[i]));
    return chart;
  }
  const std::size_t m = fan.order.size();
  std::vector<double> angle(m, 0), length(m);
  double total = 0, mean = 0;
  for (std::size_t k = 0; k < m; ++k) {
    length[k] = (x[fan.order[k]] - x[i]).norm();
    mean += length[k] / double(m);
    angle[k] = total;
    if (k + 1 < m || fan.closed) {
      const Vector3d p = x[fan.order[k]] - x[i], q = x[fan.order[(k + 1) % m]] - x[i];
      total += std::atan2(p.cross(q).norm(), p.dot(q));
    }
  }
  if (!(total > 0)) return chart;
  const double scale = fan.closed ? 2 * M_PI / total : std::min(1.0, 2 * M_PI / total);
  /// The angle of neighbour k in the uniform chart; around a whole fan from wherever one starts to count.
  const auto even = [&](std::size_t k) {
    return fan.closed ? 2 * M_PI * double(k) / double(m)
                      : scale * total * double(k) / double(std::max<std::size_t>(1, m - 1));
  };
  // Turned to lie on the other chart as well as it can, so that it does not matter where that is.
  Vector2d lead = Vector2d::Zero();
  for (std::size_t k = 0; k < m; ++k) {
    const double ahead = scale * angle[k] - even(k);
    lead += Vector2d(std::cos(ahead), std::sin(ahead));
  }
  const double offset = fan.closed ? std::atan2(lead.y(), lead.x()) : 0;
  chart.resize(m);
  for (std::size_t k = 0; k < m; ++k) {
    const double a = scale * angle[k], e = offset + even(k);
    Vector2d p = length[k] * Vector2d(std::cos(a), std::sin(a));
    const Vector2d uniform = mean * Vector2d(std::cos(e), std::sin(e));
    if (kind == Chart::mixed) p = 0.5 * (p + uniform);
    if (kind == Chart::uniform) p = uniform;
    chart[std::size_t(std::lower_bound(row.begin(), row.end(), fan.order[k]) - row.begin())] = p;
  }
  return chart;
}

}  // namespace

DividedDifferences::DividedDifferences(const Mesh& mesh, Chart chart, const Context& context)
    : rows_(mesh.one_ring) {
  constexpr double kRidge = 1e-6;  // of a fit whose columns are of size one
  constexpr double kTiny = 1e-12;  // keeps the fit of one or two neighbours regular
  const std::size_t n = mesh.positions.size();
  const Fans fans = fans_of(mesh, context);
  const Adjacency& faces = fans.faces;
  const Positions normal = unsigned_normals(mesh, fans, context);
  const Operator op = curvature(mesh, faces, context);
  const double h = std::sqrt(op.unit);
  coefficient_.assign(rows_.items.size(), Vector3d::Zero());
  reverse_.resize(rows_.items.size());
  weight_.resize(n);
  for_each_index(context, n, [&](std::size_t i) {
    weight_[i] = op.mass[i] / (2 * op.unit);
    const auto row = rows_[i];
    for (std::size_t k = 0; k < row.size(); ++k)
      reverse_[rows_.start[i] + k] = item_of(rows_, row[k], Index(i));
    const std::vector<Vector2d> uv = chart_of(mesh, faces, normal[i], Index(i), chart);
    double size = 0;
    for (const Vector2d& p : uv) size += p.squaredNorm() / double(uv.size());
    if (!(size > 0) || !std::isfinite(size)) return;
    size = std::sqrt(size);
    using Vector5 = Eigen::Matrix<double, 5, 1>;
    // unknowns x_u, x_v, x_uu, sqrt(2) x_uv, x_vv: their norm does not depend on how the chart is turned
    const auto terms = [&](const Vector2d& p) {
      const double u = p.x() / size, v = p.y() / size;
      return (Vector5() << u, v, 0.5 * u * u, std::sqrt(0.5) * u * v, 0.5 * v * v).finished();
    };
    // on the second derivatives; the slope is fitted first, so that linear functions have no energy
    Eigen::Matrix<double, 5, 5> squares =
        (Vector5() << kTiny, kTiny, kRidge, kRidge, kRidge).finished().asDiagonal();
    for (const Vector2d& p : uv) {
      const Vector5 t = terms(p);
      squares += t * t.transpose();
    }
    const Eigen::LLT<Eigen::Matrix<double, 5, 5>> factor(squares);
    const double unit = h * h / (size * size);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const Vector5 c = factor.solve(terms(uv[k]));
      const Vector3d second = unit * c.tail<3>();
      if (second.allFinite()) coefficient_[rows_.start[i] + k] = second;
    }
  });
}

DividedDifferences::Second DividedDifferences::second(const Positions& x, std::size_t i) const {
  Second s{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  for (Index k = rows_.start[i]; k < rows_.start[i + 1]; ++k) {
    const Vector3d d = x[rows_.items[k]] - x[i];
    s.uu += coefficient_[k][0] * d;
    s.uv += coefficient_[k][1] * d;
    s.vv += coefficient_[k][2] * d;
  }
  return s;
}

void DividedDifferences::apply(const Positions& x, Positions& y, const Context& context) const {
  const std::size_t n = x.size();
  scratch_.resize(n);
  y.resize(n);
  for_each_index(context, n, [&](std::size_t i) {
    Second s = second(x, i);
    s.uu *= weight_[i];
    s.uv *= weight_[i];
    s.vv *= weight_[i];
    scratch_[i] = s;
  });
  for_each_index(context, n, [&](std::size_t i) {
    Vector3d sum = Vector3d::Zero(), own = Vector3d::Zero();
    for (Index k = rows_.start[i]; k < rows_.start[i + 1]; ++k) {
      const Vector3d& back = coefficient_[reverse_[k]];
      const Second& s = scratch_[rows_.items[k]];
      sum += back[0] * s.uu + back[1] * s.uv + back[2] * s.vv;
      own += coefficient_[k];
    }
    const Second& s = scratch_[i];
    y[i] = sum - (own[0] * s.uu + own[1] * s.uv + own[2] * s.vv);
  });
}

std::vector<double> DividedDifferences::diagonal(const Context& context) const {
  std::vector<double> d(weight_.size());
  for_each_index(context, d.size(), [&](std::size_t i) {
    Vector3d own = Vector3d::Zero();
    for (Index k = rows_.start[i]; k < rows_.start[i + 1]; ++k) {
      own += coefficient_[k];
      d[i] += weight_[rows_.items[k]] * coefficient_[reverse_[k]].squaredNorm();
    }
    d[i] += weight_[i] * own.squaredNorm();
  });
  return d;
}

}  // namespace rfsmooth::smoothing
