#include "rfsmooth/smoothing/solver.h"

#include <cmath>
#include <stdexcept>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;

namespace {

/// r.z and the residual's norm, gathered in one pass.
struct Sums {
  double rz = 0, norm = 0;
};

}  // namespace

SolverReport conjugate_gradients(const Product& product, const std::vector<double>& diagonal,
                                 const std::vector<double>& mass, const Positions& b, Positions& x,
                                 const AllowedMoves& allowed, const SolverOptions& options,
                                 const Context& context) {
  const std::size_t n = b.size();
  const bool linf = options.linf;
  std::vector<double> inverse(n), weight(n);  // multiplications instead of divisions in every pass
  for_each_index(context, n, [&](std::size_t i) {
    inverse[i] = 1 / diagonal[i];
    weight[i] = linf ? 1 / (mass[i] * mass[i]) : 1 / mass[i];
  });
  const auto join = [linf](double u, double v) { return linf ? std::max(u, v) : u + v; };
  /// `update(i)` for all i, returning the sums of the residual that it returns.
  const auto gather = [&](auto&& update) {
    return reduce_blocks(
        context, n, Sums{},
        [&](std::size_t begin, std::size_t end) {
          Sums s;
          for (std::size_t i = begin; i < end; ++i) {
            const Vector3d r = update(i);
            const double square = r.squaredNorm();
            s.rz += square * inverse[i];
            s.norm = join(s.norm, square * weight[i]);
          }
          return s;
        },
        [&](Sums u, const Sums& v) {
          return Sums{u.rz + v.rz, join(u.norm, v.norm)};
        });
  };
  const double goal = options.tolerance * std::sqrt(gather([&](std::size_t i) { return b[i]; }).norm);

  Positions r(n), p(n), y(n);
  product(x, y);
  Sums sums = gather([&](std::size_t i) { return r[i] = allowed(i, b[i] - y[i]); });
  SolverReport report;
  const auto relative = [&](double norm) {
    return goal > 0 ? std::sqrt(norm) / goal * options.tolerance : 0;
  };
  // x follows one pass behind, in the pass that reads the old direction anyway.
  double previous = 0, alpha = 0;
  while (report.iterations < options.max_iterations && std::sqrt(sums.norm) > goal) {
    const double beta = report.iterations == 0 ? 0 : sums.rz / previous;
    for_each_index(context, n, [&](std::size_t i) {
      if (beta != 0) x[i] += alpha * p[i];
      p[i] = beta == 0 ? Vector3d(inverse[i] * r[i]) : Vector3d(inverse[i] * r[i] + beta * p[i]);
    });
    const double curvature = product(p, y);
    alpha = 0;
    if (!(curvature > 0) || !std::isfinite(sums.rz / curvature)) break;
    alpha = sums.rz / curvature;
    previous = sums.rz;
    sums = gather([&](std::size_t i) { return r[i] -= alpha * allowed(i, y[i]); });
    ++report.iterations;
  }
  if (alpha != 0) for_each_index(context, n, [&](std::size_t i) { x[i] += alpha * p[i]; });
  report.residual = relative(sums.norm);
  report.converged = std::sqrt(sums.norm) <= goal;
  return report;
}

namespace {

/// The matrix of a Fairing, without forming it.
class Matrix {
 public:
  Matrix(const Fairing& system, const Context& context) : s_(system), context_(context) {
    for (int k = 0; k < 4; ++k)
      if (s_.a[k] != 0) order_ = k + 1;
  }

  double multiply(const Positions& x, Positions& y) {
    const std::vector<double>& mass = s_.op.mass;
    const std::vector<double>& data = s_.data.empty() ? mass : s_.data;
    const std::size_t n = x.size();
    y.resize(n);
    if (order_ <= 1)
      return sum_over(context_, n, 0.0, [&](std::size_t i) {
        y[i] = data[i] * x[i] + s_.a[0] * difference(x, i);
        return x[i].dot(y[i]);
      });
    level_.resize(n);
    for_each_index(context_, n, [&](std::size_t i) {
      const Vector3d d = difference(x, i);
      y[i] = data[i] * x[i] + s_.a[0] * d;
      level_[i] = ((s_.strength.empty() ? 1 : s_.strength[i]) / mass[i]) * d;
    });
    for (int k = 1; k + 1 < order_; ++k) {
      next_.resize(n);
      for_each_index(context_, n, [&](std::size_t i) {
        const Vector3d d = difference(level_, i);
        y[i] += s_.a[k] * d;
        next_[i] = (1 / mass[i]) * d;
      });
      level_.swap(next_);
    }
    return sum_over(context_, n, 0.0, [&](std::size_t i) {
      y[i] += s_.a[order_ - 1] * difference(level_, i);
      return x[i].dot(y[i]);
    });
  }

  /// The diagonal; exact up to second order, an estimate above it (enough for a preconditioner).
  std::vector<double> diagonal() const {
    const std::vector<double>& mass = s_.op.mass;
    const std::vector<double>& data = s_.data.empty() ? mass : s_.data;
    std::vector<double> result(mass.size());
    for_each_index(context_, result.size(), [&](std::size_t i) {
      double own = 0, second = 0;
      for (Index k = s_.rows.start[i]; k < s_.rows.start[i + 1]; ++k) {
        const double w = s_.op.weight.empty() ? 1 : s_.op.weight[k];
        own += w;
        if (s_.a[1] == 0) continue;
        const Index j = s_.rows.items[k];
        second += w * w * (s_.strength.empty() ? 1 : s_.strength[j]) / mass[j];
      }
      second += own * own * (s_.strength.empty() ? 1 : s_.strength[i]) / mass[i];
      const double rate = std::abs(own) / mass[i];
      const double d = data[i] + s_.a[0] * own + s_.a[1] * second + s_.a[2] * mass[i] * rate * rate * rate +
                       s_.a[3] * mass[i] * rate * rate * rate * rate;
      result[i] = d > 0 && std::isfinite(d) ? d : mass[i];
    });
    return result;
  }

 private:
  /// (S x)_i
  Vector3d difference(const Positions& x, std::size_t i) const {
    const Index begin = s_.rows.start[i], end = s_.rows.start[i + 1];
    const Index* const items = s_.rows.items.data();
    Vector3d sum = Vector3d::Zero();
    if (s_.op.weight.empty()) {
      for (Index k = begin; k < end; ++k) sum += x[items[k]];
      return double(end - begin) * x[i] - sum;
    }
    for (Index k = begin; k < end; ++k) sum += s_.op.weight[k] * (x[i] - x[items[k]]);
    return sum;
  }

  const Fairing& s_;
  const Context& context_;
  int order_ = 0;
  Positions level_, next_;
};

}  // namespace

SolverReport solve(const Fairing& system, const Positions& o, Positions& x, const AllowedMoves& allowed,
                   const SolverOptions& options, const Context& context) {
  const std::size_t n = o.size();
  const std::vector<double>& data = system.data.empty() ? system.op.mass : system.data;
  if (system.rows.size() != n || system.op.mass.size() != n || data.size() != n ||
      (!system.strength.empty() && system.strength.size() != n) ||
      (!system.op.weight.empty() && system.op.weight.size() != system.rows.items.size()))
    throw std::invalid_argument("the arrays of a Fairing differ in size");
  if (!system.strength.empty() && (system.a[2] != 0 || system.a[3] != 0))
    throw std::invalid_argument("a Fairing with a strength per vertex has order two at most");
  if (n == 0) return {0, 0, true};

  const bool warm = x.size() == n;
  x.resize(n);
  const Vector3d centre =
      sum_over(context, n, Vector3d(Vector3d::Zero()), [&](std::size_t i) { return o[i]; }) / double(n);
  Positions b(n), iterate(n);
  for_each_index(context, n, [&](std::size_t i) {
    if (!warm) x[i] = o[i];
    b[i] = data[i] * (o[i] - centre);
    iterate[i] = x[i] - centre;
  });
  Matrix matrix(system, context);
  const SolverReport report =
      conjugate_gradients([&](const Positions& u, Positions& v) { return matrix.multiply(u, v); },
                          matrix.diagonal(), system.op.mass, b, iterate, allowed, options, context);
  for_each_index(context, n, [&](std::size_t i) {
    // The move, not the position: vertices that may not move keep their bits.
    const Vector3d place = x[i] + allowed(i, iterate[i] - (x[i] - centre));
    if (place.allFinite()) x[i] = place;
  });
  return report;
}

}  // namespace rfsmooth::smoothing
