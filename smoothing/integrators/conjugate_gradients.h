/// The conjugate gradient iteration behind solver.h, in double or in single precision.
///
/// Hestenes, Stiefel 1952, with a Jacobi preconditioner; Desbrun et al. 1999, 2.4-2.5. The three coordinates
/// are one system with a common step length. An iteration makes four passes over the vectors. Sums are taken
/// in double over fixed blocks, so the bits do not depend on the number of threads. Thread safe for different
/// vectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "smoothing/modifiers/constraint.h"

namespace rfsmooth::smoothing {

/// Of Eigen::Vector3d, or of Eigen::Vector4f with fourth number 0, which loads a neighbour at once.
template <class Vector>
using Vectors = std::vector<Vector>;

/// One number per vertex. Not initialised, so that threads first touch the pages in parallel.
template <class Scalar>
using Numbers = Eigen::Array<Scalar, Eigen::Dynamic, 1>;

/// The part of a move that the hard constraints allow, in either precision.
inline Eigen::Vector3d allowed_part(const AllowedMoves& allowed, std::size_t i, const Eigen::Vector3d& move) {
  return allowed(i, move);
}
/// The same; the fourth number is not a coordinate.
inline Eigen::Vector4f allowed_part(const AllowedMoves& allowed, std::size_t i, const Eigen::Vector4f& move) {
  if (allowed.all_free()) return move;
  Eigen::Vector4f part = Eigen::Vector4f::Zero();
  part.head<3>() = allowed(i, Eigen::Vector3d(move.head<3>().cast<double>())).cast<float>();
  return part;
}

/// The diagonal scalings of the iteration: 1 / A's diagonal and the weights of the residual's norm.
template <class Scalar>
struct Scales {
  Numbers<Scalar> inverse;
  Numbers<Scalar> norm;
  bool largest = false;  ///< norm: the largest weighted residual, not the root of the sum of squares
};

/// r.z, z the preconditioned residual, and the squared norm of r.
struct ResidualSums {
  double rz = 0, square = 0;
};

/// Calls `update(i)`, which returns the residual at i, for all i; returns the sums over these.
template <class Scalar, class Update>
ResidualSums residual_sums(const Context& context, std::size_t n, const Scales<Scalar>& scales,
                           Update&& update) {
  const bool largest = scales.largest;
  const auto join = [largest](double u, double v) { return largest ? std::max(u, v) : u + v; };
  return reduce_blocks(
      context, n, ResidualSums{},
      [&](std::size_t begin, std::size_t end) {
        ResidualSums s;
        for (std::size_t i = begin; i < end; ++i) {
          const double square = double(update(i).squaredNorm());
          s.rz += square * double(scales.inverse[Eigen::Index(i)]);
          s.square = join(s.square, square * double(scales.norm[Eigen::Index(i)]));
        }
        return s;
      },
      [&](const ResidualSums& u, const ResidualSums& v) {
        return ResidualSums{u.rz + v.rz, join(u.square, v.square)};
      });
}

/// How the iteration ended.
struct Iterated {
  int iterations = 0;
  double norm = 0;  ///< of the recursive residual
};

/// The allowed part of b - A x, n rows, and its sums.
template <class Vector>
struct Residual {
  Vectors<Vector>& r;
  ResidualSums sums;
};

/// When the iteration is to end: at a norm of the residual, or after so many rounds.
struct Until {
  double norm;
  int iterations;
};

/// Solves A x = b from a residual, which follows x. `product(p, y)` sets y = A p and returns p . y. A
/// breakdown stops at the last iterate.
template <class Vector, class Product>
Iterated conjugate_gradient_iteration(Product&& product, const Scales<typename Vector::Scalar>& scales,
                                      const Residual<Vector>& from, Vectors<Vector>& x,
                                      const AllowedMoves& allowed, const Until& until,
                                      const Context& context) {
  using Scalar = typename Vector::Scalar;
  Vectors<Vector>& r = from.r;
  ResidualSums sums = from.sums;
  const std::size_t n = r.size();
  Vectors<Vector> p(n), y(n);
  Iterated done;
  // x follows one pass behind, in the pass that reads the old direction anyway.
  double previous = 0, alpha = 0;
  while (done.iterations < until.iterations && std::sqrt(sums.square) > until.norm) {
    const Scalar beta = done.iterations == 0 ? Scalar(0) : Scalar(sums.rz / previous), step = Scalar(alpha);
    const bool first = done.iterations == 0;
    for_each_index(context, n, [&](std::size_t i) {
      if (first) {
        p[i] = scales.inverse[Eigen::Index(i)] * r[i];
        return;
      }
      x[i] += step * p[i];
      p[i] = scales.inverse[Eigen::Index(i)] * r[i] + beta * p[i];
    });
    const double curvature = product(p, y);
    alpha = 0;
    if (!(curvature > 0) || !std::isfinite(sums.rz / curvature)) break;
    alpha = sums.rz / curvature;
    previous = sums.rz;
    const Scalar length = Scalar(alpha);
    sums = residual_sums(context, n, scales, [&](std::size_t i) -> const Vector& {
      return r[i] -= length * allowed_part(allowed, i, y[i]);
    });
    ++done.iterations;
  }
  if (alpha != 0) for_each_index(context, n, [&](std::size_t i) { x[i] += Scalar(alpha) * p[i]; });
  done.norm = std::sqrt(sums.square);
  return done;
}

}  // namespace rfsmooth::smoothing
