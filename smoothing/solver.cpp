#include "rfsmooth/smoothing/solver.h"

#include <cmath>
#include <stdexcept>

#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/smoothing/conjugate_gradients.h"
#include "rfsmooth/smoothing/fairing_matrix.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using Eigen::Vector4f;

namespace {

template <class Scalar>
std::vector<Scalar> norm_weights(const std::vector<double>& mass, double unit, bool largest,
                                 const Context& context) {
  std::vector<Scalar> weight(mass.size());
  for_each_index(context, weight.size(), [&](std::size_t i) {
    const double m = mass[i] / unit;
    weight[i] = Scalar(largest ? 1 / (m * m) : 1 / m);
  });
  return weight;
}

double relative(double norm, double goal, double tolerance) {
  return goal > 0 ? norm / goal * tolerance : 0;
}

}  // namespace

SolverReport conjugate_gradients(const Product& product, const std::vector<double>& diagonal,
                                 const std::vector<double>& mass, const Positions& b, Positions& x,
                                 const AllowedMoves& allowed, const SolverOptions& options,
                                 const Context& context) {
  const std::size_t n = b.size();
  Scales<double> scales{std::vector<double>(n), norm_weights<double>(mass, 1, options.linf, context),
                        options.linf};
  for_each_index(context, n, [&](std::size_t i) { scales.inverse[i] = 1 / diagonal[i]; });
  const double goal =
      options.tolerance * std::sqrt(residual_sums(context, n, scales, [&](std::size_t i) -> const Vector3d& {
                                      return b[i];
                                    }).square);
  Positions r(n), y(n);
  product(x, y);
  const ResidualSums sums = residual_sums(
      context, n, scales, [&](std::size_t i) -> const Vector3d& { return r[i] = allowed(i, b[i] - y[i]); });
  const Iterated done = conjugate_gradient_iteration<Vector3d>(context, product, scales, r, sums, x, allowed,
                                                               goal, options.max_iterations);
  return {done.iterations, relative(done.norm, goal, options.tolerance), done.norm <= goal};
}

namespace {

/// One solve: the residual in double precision, corrections in single precision, which halves the memory that
/// every iteration walks through. Where a correction does not help, in double precision to the end.
class FairingSolve {
 public:
  FairingSolve(const Fairing& system, const AllowedMoves& allowed, const SolverOptions& options,
               const Context& context)
      : system_(system),
        allowed_(allowed),
        options_(options),
        context_(context),
        n_(system.op.mass.size()),
        mean_mass_(sum_over(context, n_, 0.0, [&](std::size_t i) { return system.op.mass[i]; }) / double(n_)),
        exact_(system, mean_mass_, context),
        norm_{{}, norm_weights<double>(system.op.mass, mean_mass_, options.linf, context), options.linf} {
    norm_.inverse = norm_.norm;  // r.z is not used of it
  }

  /// \param o around the centre; x likewise.
  SolverReport run(const Positions& o, Positions& x) {
    const std::vector<double>& data = system_.data.empty() ? system_.op.mass : system_.data;
    b_.resize(n_);
    r_.resize(n_);
    const double size = residual_sums(context_, n_, norm_, [&](std::size_t i) -> const Vector3d& {
                          return b_[i] = data[i] / mean_mass_ * o[i];
                        }).square;
    const double goal = options_.tolerance * std::sqrt(size);
    SolverReport report;
    double norm = residual(x);
    while (norm > goal && std::isfinite(norm) && report.iterations < options_.max_iterations) {
      const double before = norm;
      correct(norm, goal, x, report.iterations);
      norm = residual(x);
      if (!(norm > goal)) break;
      if (norm > kWorthwhile * before) {
        norm = finish_in_double(goal, x, report.iterations);
        break;
      }
    }
    report.residual = relative(norm, goal, options_.tolerance);
    report.converged = norm <= goal;
    return report;
  }

 private:
  /// A correction that leaves more than this of the residual met the limits of single precision.
  static constexpr double kWorthwhile = 0.5;
  /// Single precision has seven digits; a correction is asked for at most four of them.
  static constexpr double kCorrection = 1e-4;

  double residual(const Positions& x) {
    y_.resize(n_);
    exact_.multiply(x, y_);
    return std::sqrt(residual_sums(context_, n_, norm_, [&](std::size_t i) -> const Vector3d& {
                       return r_[i] = allowed_(i, b_[i] - y_[i]);
                     }).square);
  }

  /// Adds a solution of A d = r in single precision to x.
  void correct(double norm, double goal, Positions& x, int& iterations) {
    FairingMatrix<Vector4f> matrix(system_, mean_mass_, context_);
    const Scales<float> scales{matrix.inverse_diagonal(),
                               norm_weights<float>(system_.op.mass, mean_mass_, options_.linf, context_),
                               options_.linf};
    Vectors<Vector4f> r(n_), d(n_);
    const ResidualSums sums = residual_sums(context_, n_, scales, [&](std::size_t i) -> const Vector4f& {
      r[i].head<3>() = (r_[i] / norm).cast<float>();
      r[i][3] = 0;
      d[i].setZero();
      return r[i];
    });
    constexpr double kSlack = 0.95;  // for what rounding adds between this residual and the exact one
    const Iterated done = conjugate_gradient_iteration<Vector4f>(
        context_, [&](const Vectors<Vector4f>& u, Vectors<Vector4f>& v) { return matrix.multiply(u, v); },
        scales, r, sums, d, allowed_, std::max(kSlack * goal / norm, kCorrection),
        options_.max_iterations - iterations);
    iterations += done.iterations;
    for_each_index(context_, n_, [&](std::size_t i) {
      const Vector3d move = norm * d[i].head<3>().cast<double>();
      if (move.allFinite()) x[i] += allowed_(i, move);
    });
  }

  /// From the residual r_ of x. \return the norm of the recursive residual.
  double finish_in_double(double goal, Positions& x, int& iterations) {
    Scales<double> scales = norm_;
    scales.inverse = exact_.inverse_diagonal();
    const ResidualSums sums =
        residual_sums(context_, n_, scales, [&](std::size_t i) -> const Vector3d& { return r_[i]; });
    const Iterated done = conjugate_gradient_iteration<Vector3d>(
        context_, [&](const Positions& u, Positions& v) { return exact_.multiply(u, v); }, scales, r_, sums,
        x, allowed_, goal, options_.max_iterations - iterations);
    iterations += done.iterations;
    return done.norm;
  }

  const Fairing& system_;
  const AllowedMoves& allowed_;
  const SolverOptions& options_;
  const Context& context_;
  std::size_t n_;
  double mean_mass_;
  FairingMatrix<Vector3d> exact_;
  Scales<double> norm_;
  Positions b_, r_, y_;
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
  Positions centred(n), iterate(n);
  for_each_index(context, n, [&](std::size_t i) {
    if (!warm) x[i] = o[i];
    centred[i] = o[i] - centre;
    iterate[i] = x[i] - centre;
  });
  const SolverReport report = FairingSolve(system, allowed, options, context).run(centred, iterate);
  for_each_index(context, n, [&](std::size_t i) {
    // The move, not the position: vertices that may not move keep their bits.
    const Vector3d place = x[i] + allowed(i, iterate[i] - (x[i] - centre));
    if (place.allFinite()) x[i] = place;
  });
  return report;
}

}  // namespace rfsmooth::smoothing
