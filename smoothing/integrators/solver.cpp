#include "smoothing/integrators/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/parallel.h"
#include "smoothing/integrators/chebyshev.h"
#include "smoothing/integrators/conjugate_gradients.h"
#include "smoothing/integrators/fairing_matrix.h"

namespace rfsmooth::smoothing {

using Eigen::Vector3d;
using Eigen::Vector4f;

namespace {

template <class Scalar>
Numbers<Scalar> norm_weights(const std::vector<double>& mass, double unit, bool largest,
                             const Context& context) {
  Numbers<Scalar> weight(Eigen::Index(mass.size()));
  for_each_index(context, mass.size(), [&](std::size_t i) {
    const double w = unit / mass[i];
    weight[Eigen::Index(i)] = Scalar(largest ? w * w : w);
  });
  return weight;
}

double relative(double norm, double goal, double tolerance) {
  return goal > 0 ? norm / goal * tolerance : 0;
}

/// The norm of what rounding leaves of a residual where the terms of A x are so large.
double rounding_of(double terms) {
  constexpr double kRoundings = 8;  // in a row of neighbours, one on top of the other
  return kRoundings * std::numeric_limits<double>::epsilon() * terms;
}

}  // namespace

SolverReport conjugate_gradients(const LinearSystem& system, const Positions& b, Positions& x,
                                 const AllowedMoves& allowed, const SolverOptions& options,
                                 const Context& context) {
  const std::size_t n = b.size();
  const std::vector<double>&diagonal = system.diagonal, &mass = system.mass;
  Scales<double> scales{Numbers<double>(Eigen::Index(n)),
                        norm_weights<double>(mass, 1, options.linf, context), options.linf};
  for_each_index(context, n, [&](std::size_t i) { scales.inverse[Eigen::Index(i)] = 1 / diagonal[i]; });
  const double goal =
      options.tolerance * std::sqrt(residual_sums(context, n, scales, [&](std::size_t i) -> const Vector3d& {
                                      return b[i];
                                    }).square);
  Positions r(n), y(n);
  system.product(x, y);
  const ResidualSums sums = residual_sums(
      context, n, scales, [&](std::size_t i) -> const Vector3d& { return r[i] = allowed(i, b[i] - y[i]); });
  const Iterated done = conjugate_gradient_iteration<Vector3d>(system.product, scales, {r, sums}, x, allowed,
                                                               {goal, options.max_iterations}, context);
  const auto terms = [&] {
    // A is positive semi-definite: its largest eigenvalue is about twice the largest of its diagonal.
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, diagonal[i] / mass[i]);
    const auto weighed = [&](std::size_t i) { return Vector3d(mass[i] * x[i]); };
    return 2 * largest * std::sqrt(residual_sums(context, n, scales, weighed).square);
  };
  return {done.iterations, relative(done.norm, goal, options.tolerance),
          done.norm <= goal || done.norm <= rounding_of(terms())};
}

namespace {

/// One solve: the residual in double precision, corrections in single precision, which halves the memory that
/// every iteration walks through. Where a correction does not help, in double precision to the end.
class FairingSolve {
 public:
  FairingSolve(const Fairing& system, const Positions& o, Positions& x, const AllowedMoves& allowed,
               const SolverOptions& options, const Context& context)
      : s_(system), o_(o), x_(x), allowed_(allowed), options_(options), context_(context), n_(o.size()) {}

  SolverReport run() {
    measure();
    SolverReport report;
    Vectors<Vector4f> r(n_);
    const double per_unit = 1 / (mean_mass_ * length_);
    const auto as_float = [&](std::size_t i, const Vector3d& v) {
      const Vector3d scaled = per_unit * v;
      r[i] = Vector4f(float(scaled[0]), float(scaled[1]), float(scaled[2]), 0);
    };
    double norm = residual(as_float);
    if (options_.of_start)
      goal_ = std::max(options_.tolerance * norm, rounding_of(largest_eigenvalue() * size_));
    report.by_polynomials = norm > goal_;
    while (norm > goal_ && std::isfinite(norm) && report.iterations < options_.max_iterations) {
      const double before = norm;
      if (!correct_by_polynomial(r, norm, report.iterations)) {
        report.by_polynomials = false;
        correct_by_iteration(r, norm, report.iterations);
      }
      norm = residual(as_float);
      if (norm > goal_ && norm > kWorthwhile * before) {
        report.by_polynomials = false;
        norm = finish_in_double(report.iterations);
        break;
      }
    }
    report.residual = relative(norm, goal_, options_.tolerance);
    report.converged = norm <= goal_ || norm <= rounding_of(largest_eigenvalue() * size_);
    return report;
  }

 private:
  /// The kind of the operator, its masses, the goal, and the units of single precision.
  void measure() {
    struct Sums {
      Vector3d x = Vector3d::Zero();
      double mass = 0;
      std::size_t other_mass = 0;  ///< vertices whose mass is not their degree
      Sums& operator+=(const Sums& other) {
        x += other.x;
        mass += other.mass;
        other_mass += other.other_mass;
        return *this;
      }
    };
    const Sums sums = sum_over(context_, n_, Sums{}, [&](std::size_t i) {
      const double degree = double(std::max<std::size_t>(1, s_.rows.degree(i)));
      return Sums{o_[i], s_.op.mass[i], s_.op.mass[i] != degree};
    });
    umbrella_ = s_.op.weight.empty() && sums.other_mass == 0;
    mean_mass_ = sums.mass / double(n_);
    const Vector3d centre = sums.x / double(n_);
    size_ = norm_of([&](std::size_t i) { return Vector3d(data(i) * (o_[i] - centre)); });
    goal_ = options_.tolerance * size_;
    // Single precision sees lengths in this unit and the norm in that one.
    length_ = options_.linf ? size_ : size_ / std::sqrt(mean_mass_ * double(n_));
    if (!(length_ > 0)) length_ = 1;
    norm_unit_ = options_.linf ? length_ : length_ * std::sqrt(mean_mass_);
  }

  /// A correction that leaves more than this of the residual met the limits of single precision.
  static constexpr double kWorthwhile = 0.5;
  /// Single precision has seven digits; a correction is asked for at most four of them.
  static constexpr double kCorrection = 1e-4;
  /// For what rounding adds between the residual of the iteration and the exact one.
  static constexpr double kSlack = 0.95;

  double data(std::size_t i) const { return s_.data.empty() ? s_.op.mass[i] : s_.data[i]; }

  /// Of M^-1 A, at most: S has none above twice its largest diagonal over the mass.
  double largest_eigenvalue() const {
    double of_s = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      double diagonal = s_.op.weight.empty() ? double(s_.rows.degree(i)) : 0;
      for (Index k = s_.rows.start[i]; k < s_.rows.start[i + 1] && !s_.op.weight.empty(); ++k)
        diagonal += std::abs(s_.op.weight[k]);
      of_s = std::max(of_s, 2 * diagonal / s_.op.mass[i]);
    }
    double sum = 1, power = 1;
    for (const double a : s_.a) sum += std::abs(a) * (power *= of_s);
    return sum;
  }

  /// The norm of a residual given by vertex.
  template <class Residual>
  double norm_of(Residual&& r) const {
    const bool largest = options_.linf;
    const auto join = [largest](double u, double v) { return largest ? std::max(u, v) : u + v; };
    return std::sqrt(reduce_blocks(
        context_, n_, 0.0,
        [&](std::size_t begin, std::size_t end) {
          double sum = 0;
          for (std::size_t i = begin; i < end; ++i) {
            const double m = s_.op.mass[i];
            sum = join(sum, r(i).squaredNorm() / (largest ? m * m : m));
          }
          return sum;
        },
        join));
  }

  /// (S x)_i, from differences, so that it does not matter where the origin is.
  template <bool kWeighted>
  Vector3d difference(const Positions& x, std::size_t i) const {
    const Index* const items = s_.rows.items.data();
    const Vector3d& own = x[i];
    Vector3d sum = Vector3d::Zero();
    for (Index k = s_.rows.start[i]; k < s_.rows.start[i + 1]; ++k) {
      if constexpr (kWeighted)
        sum += s_.op.weight[k] * (own - x[items[k]]);
      else
        sum += own - x[items[k]];
    }
    return sum;
  }

  /// store(i, r_i) of r = Q o - A x, its allowed part; returns the norm.
  template <class Store>
  double residual(Store&& store) {
    return s_.op.weight.empty() ? residual_with<false>(store) : residual_with<true>(store);
  }

  template <bool kWeighted, class Store>
  double residual_with(Store& store) {
    int order = 1;
    for (int k = 1; k < 4; ++k)
      if (s_.a[std::size_t(k)] != 0) order = k + 1;
    const auto keep = [&](std::size_t i, const Vector3d& free) {
      Vector3d r = allowed_(i, free);
      store(i, r);
      return r;
    };
    const auto from_data = [&](std::size_t i) { return Vector3d(data(i) * (o_[i] - x_[i])); };
    if (order == 1)
      return norm_of(
          [&](std::size_t i) { return keep(i, from_data(i) - s_.a[0] * difference<kWeighted>(x_, i)); });
    const bool plain = order == 2 && s_.a[0] == 0;  // nothing to carry over from the first pass
    level_.resize(n_);
    Positions next(order > 2 ? n_ : 0), sum(plain ? 0 : n_);
    for_each_index(context_, n_, [&](std::size_t i) {
      const Vector3d d = difference<kWeighted>(x_, i);
      if (!plain) sum[i] = from_data(i) - s_.a[0] * d;
      level_[i] = ((s_.strength.empty() ? 1 : s_.strength[i]) / s_.op.mass[i]) * d;
    });
    for (int k = 1; k + 1 < order; ++k) {
      for_each_index(context_, n_, [&](std::size_t i) {
        const Vector3d d = difference<kWeighted>(level_, i);
        sum[i] -= s_.a[std::size_t(k)] * d;
        next[i] = (1 / s_.op.mass[i]) * d;
      });
      level_.swap(next);
    }
    return norm_of([&](std::size_t i) {
      const Vector3d d = s_.a[std::size_t(order) - 1] * difference<kWeighted>(level_, i);
      return keep(i, (plain ? from_data(i) : sum[i]) - d);
    });
  }

  /// Adds a solution of A d = r in single precision to x; r is overwritten. For the umbrella with the data's
  /// own mass, second order: the degree that it takes is known beforehand. False for all else.
  bool correct_by_polynomial(Vectors<Vector4f>& r, double norm, int& iterations) {
    const bool plain = umbrella_ && s_.data.empty() && s_.strength.empty() && allowed_.all_free();
    if (!plain || options_.linf || !(s_.a[1] > 0 && s_.a[0] >= 0) || s_.a[2] != 0 || s_.a[3] != 0)
      return false;
    constexpr int kMost = 2000;
    const auto polynomial = inverse_polynomial(s_.a[0], s_.a[1], std::max(kSlack * goal_ / norm, kCorrection),
                                               std::min(kMost, 2 * (options_.max_iterations - iterations)));
    if (!polynomial) return false;
    iterations += int(polynomial->size() + 1) / 2;
    Vectors<Vector4f> d(n_);
    for_each_index(context_, n_, [&](std::size_t i) { r[i] *= float(mean_mass_ / s_.op.mass[i]); });
    apply_polynomial(*polynomial, s_.rows, r, d, context_);
    for_each_index(context_, n_, [&](std::size_t i) { move(i, length_ * d[i].head<3>().cast<double>()); });
    return true;
  }

  /// The same for every system.
  void correct_by_iteration(Vectors<Vector4f>& r, double norm, int& iterations) {
    if (!matrix_) {
      matrix_.emplace(s_, mean_mass_, context_);
      scales_ = {matrix_->inverse_diagonal(),
                 norm_weights<float>(s_.op.mass, mean_mass_, options_.linf, context_), options_.linf};
    }
    Vectors<Vector4f> d(n_);
    const ResidualSums sums = residual_sums(context_, n_, scales_, [&](std::size_t i) -> const Vector4f& {
      d[i].setZero();
      return r[i];
    });
    const double goal = std::max(kSlack * goal_, kCorrection * norm) / norm_unit_;
    iterations +=
        conjugate_gradient_iteration<Vector4f>(
            [&](const Vectors<Vector4f>& u, Vectors<Vector4f>& v) { return matrix_->multiply(u, v); },
            scales_, {r, sums}, d, allowed_, {goal, options_.max_iterations - iterations}, context_)
            .iterations;
    for_each_index(context_, n_, [&](std::size_t i) { move(i, length_ * d[i].head<3>().cast<double>()); });
  }

  /// \return the norm of the recursive residual.
  double finish_in_double(int& iterations) {
    matrix_.reset();
    FairingMatrix<Vector3d> matrix(s_, mean_mass_, context_);
    const Scales<double> scales{matrix.inverse_diagonal(),
                                norm_weights<double>(s_.op.mass, mean_mass_, options_.linf, context_),
                                options_.linf};
    Positions r(n_), d(n_);
    residual([&](std::size_t i, const Vector3d& v) {
      r[i] = v / (mean_mass_ * length_);
      d[i].setZero();
    });
    const ResidualSums sums =
        residual_sums(context_, n_, scales, [&](std::size_t i) -> const Vector3d& { return r[i]; });
    const Iterated done = conjugate_gradient_iteration<Vector3d>(
        [&](const Positions& u, Positions& v) { return matrix.multiply(u, v); }, scales, {r, sums}, d,
        allowed_, {goal_ / norm_unit_, options_.max_iterations - iterations}, context_);
    iterations += done.iterations;
    for_each_index(context_, n_, [&](std::size_t i) { move(i, length_ * d[i]); });
    return done.norm * norm_unit_;
  }

  /// Vertices that may not move keep their bits.
  void move(std::size_t i, const Vector3d& by) {
    const Vector3d place = x_[i] + allowed_(i, by);
    if (place.allFinite()) x_[i] = place;
  }

  const Fairing& s_;
  const Positions& o_;
  Positions& x_;
  const AllowedMoves& allowed_;
  const SolverOptions& options_;
  const Context& context_;
  std::size_t n_;
  bool umbrella_ = false;
  double mean_mass_ = 1, size_ = 0, goal_ = 0, length_ = 1, norm_unit_ = 1;
  Positions level_;  ///< of the residual
  std::optional<FairingMatrix<Vector4f>> matrix_;
  Scales<float> scales_;
};

}  // namespace

SolverReport solve(const Fairing& system, const Positions& o, Positions& x, const AllowedMoves& allowed,
                   const SolverOptions& options, const Context& context) {
  const std::size_t n = o.size();
  if (system.rows.size() != n || system.op.mass.size() != n ||
      (!system.data.empty() && system.data.size() != n) ||
      (!system.strength.empty() && system.strength.size() != n) ||
      (!system.op.weight.empty() && system.op.weight.size() != system.rows.items.size()))
    throw std::invalid_argument("the arrays of a Fairing differ in size");
  if (!system.strength.empty() && (system.a[2] != 0 || system.a[3] != 0))
    throw std::invalid_argument("a Fairing with a strength per vertex has order two at most");
  if (n == 0) return {0, 0, true};
  if (x.size() != n) {
    x.resize(n);
    for_each_index(context, n, [&](std::size_t i) { x[i] = o[i]; });
  }
  return FairingSolve(system, o, x, allowed, options, context).run();
}

}  // namespace rfsmooth::smoothing
