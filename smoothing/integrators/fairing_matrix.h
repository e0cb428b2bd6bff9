/// The matrix of a Fairing (solver.h), never formed, in double or in single precision.
///
///     A = [Q + a_1 S + a_2 S C M^-1 S + a_3 S (M^-1 S)^2 + a_4 S (M^-1 S)^3] / mu
///
/// Divided by mu = the mean mass, and with S in units of mu / op.unit, its entries are of order one whatever
/// the scale of the mesh, and fit into single precision. One object per thread: products share scratch
/// memory.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "smoothing/integrators/conjugate_gradients.h"
#include "smoothing/integrators/solver.h"

namespace rfsmooth::smoothing {

/// The matrix of a fairing, laid out for fast products.
template <class Vector>
class FairingMatrix {
 public:
  using Scalar = typename Vector::Scalar;

  FairingMatrix(const Fairing& system, double mean_mass, const Context& context)
      : rows_(system.rows),
        context_(context),
        n_(system.op.mass.size()),
        data_(Eigen::Index(n_)),
        level_scale_(Eigen::Index(n_)) {
    const std::vector<double>& mass = system.op.mass;
    const std::vector<double>& data = system.data.empty() ? mass : system.data;
    const double in_units = system.op.unit / mean_mass;  // S' = in_units * S
    double unit = 1;
    for (std::size_t k = 0; k < 4; ++k) {
      unit *= system.op.unit;
      a_[k] = Scalar(system.a[k] / unit);
      if (a_[k] != 0) order_ = int(k) + 1;
    }
    graph_scale_ = Scalar(in_units);
    for_each_index(context, n_, [&](std::size_t i) {
      data_[Eigen::Index(i)] = Scalar(data[i] / mean_mass);
      level_scale_[Eigen::Index(i)] =
          Scalar(mean_mass / mass[i] * (system.strength.empty() ? 1 : system.strength[i]));
    });
    if (order_ > 2) {
      inverse_mass_.resize(Eigen::Index(n_));
      for_each_index(context, n_,
                     [&](std::size_t i) { inverse_mass_[Eigen::Index(i)] = Scalar(mean_mass / mass[i]); });
    }
    if (system.op.weight.empty()) return;
    graph_scale_ = 1;
    weighted_ = true;
    weight_.resize(Eigen::Index(system.op.weight.size()));
    for_each_index(context, system.op.weight.size(),
                   [&](std::size_t k) { weight_[Eigen::Index(k)] = Scalar(in_units * system.op.weight[k]); });
  }

  /// y = A x; returns x . y.
  double multiply(const Vectors<Vector>& x, Vectors<Vector>& y) {
    return weighted_ ? multiply_with<true>(x, y) : multiply_with<false>(x, y);
  }

  /// 1 / the diagonal. Exact up to second order; above it an estimate, good enough for a preconditioner.
  Numbers<Scalar> inverse_diagonal() const {
    Numbers<Scalar> result(data_.size());
    for_each_index(context_, n_, [&](std::size_t i) {
      double own = 0, second = 0;
      for (Index k = rows_.start[i]; k < rows_.start[i + 1]; ++k) {
        const double w = double(graph_scale_) * (weighted_ ? double(weight_[Eigen::Index(k)]) : 1.0);
        own += w;
        if (a_[1] != 0) second += w * w * double(level_scale_[Eigen::Index(rows_.items[k])]);
      }
      second += own * own * double(level_scale_[Eigen::Index(i)]);
      double d = double(data_[Eigen::Index(i)]) + double(a_[0]) * own + double(a_[1]) * second;
      if (order_ > 2) {
        const double rate = std::abs(own) * double(inverse_mass_[Eigen::Index(i)]);
        d += own * rate * rate * (double(a_[2]) + double(a_[3]) * rate);
      }
      result[Eigen::Index(i)] = Scalar(d > 0 && std::isfinite(1 / d) ? 1 / d : 1);
    });
    return result;
  }

 private:
  /// (S' x)_i
  template <bool kWeighted>
  Vector difference(const Vectors<Vector>& x, std::size_t i) const {
    const Index begin = rows_.start[i], end = rows_.start[i + 1];
    const Index* const items = rows_.items.data();
    Vector sum = Vector::Zero();
    if constexpr (kWeighted) {
      for (Index k = begin; k < end; ++k) sum += weight_[Eigen::Index(k)] * (x[i] - x[items[k]]);
      return sum;
    } else {
      for (Index k = begin; k < end; ++k) sum += x[items[k]];
      return graph_scale_ * (Scalar(end - begin) * x[i] - sum);
    }
  }

  template <bool kWeighted>
  double multiply_with(const Vectors<Vector>& x, Vectors<Vector>& y) {
    const std::size_t n = x.size();
    if (order_ <= 1)
      return sum_over(context_, n, 0.0, [&](std::size_t i) {
        y[i] = data_[Eigen::Index(i)] * x[i] + a_[0] * difference<kWeighted>(x, i);
        return double(x[i].dot(y[i]));
      });
    level_.resize(n);
    const bool plain = order_ == 2 && a_[0] == 0;  // the last pass computes all of y
    for_each_index(context_, n, [&](std::size_t i) {
      const Vector d = difference<kWeighted>(x, i);
      if (!plain) y[i] = data_[Eigen::Index(i)] * x[i] + a_[0] * d;
      level_[i] = level_scale_[Eigen::Index(i)] * d;
    });
    for (int k = 1; k + 1 < order_; ++k) {
      next_.resize(n);
      for_each_index(context_, n, [&](std::size_t i) {
        const Vector d = difference<kWeighted>(level_, i);
        y[i] += a_[std::size_t(k)] * d;
        next_[i] = inverse_mass_[Eigen::Index(i)] * d;
      });
      level_.swap(next_);
    }
    const Scalar last = a_[std::size_t(order_) - 1];
    return sum_over(context_, n, 0.0, [&](std::size_t i) {
      const Vector d = last * difference<kWeighted>(level_, i);
      y[i] = d + (plain ? Vector(data_[Eigen::Index(i)] * x[i]) : y[i]);
      return double(x[i].dot(y[i]));
    });
  }

  const Adjacency& rows_;
  const Context& context_;
  std::array<Scalar, 4> a_ = {0, 0, 0, 0};
  std::size_t n_;
  int order_ = 0;
  bool weighted_ = false;
  Scalar graph_scale_ = 1;  ///< factor of S' if the operator has no weights
  Numbers<Scalar> weight_, data_, level_scale_, inverse_mass_;
  Vectors<Vector> level_, next_;
};

}  // namespace rfsmooth::smoothing
