/// Implicit fairing: symmetric positive definite solves on a mesh, by conjugate gradients with a Jacobi
/// preconditioner.
///
///     (Q + a_1 S + a_2 S C M^-1 S + a_3 S (M^-1 S)^2 + a_4 S (M^-1 S)^3) x = Q o
///
/// S = M L of an Operator, Q = diag(data), C = diag(strength). With Q = M = D (degrees) and S = D - W this is
/// implicit fairing of first order (a_1 = dt), of second order (a_2 = dt, a smoothing spline: (D + c (D-W)
/// D^-1 (D-W)) x = D o), of higher order, and mixtures of these (Desbrun et al. 1999, 2.3-2.6 and appendix
/// A). In this symmetric form CG suffices where the paper uses BiCG.
///
/// The three coordinates are one system of 3n unknowns with a common step length, so the iterates turn with
/// the cloud. The right side is centred first, since the stopping test depends on the origin:
///
///     |A x - b| < tolerance |b|    in the inner product of M^-1 (l2), or per vertex over m_i (linf)
///
/// What this asks for grows with the extent of the cloud. Relative to the residual of the start it does not:
/// each part of the start's error, coarse or fine, is reduced by the tolerance or more where one polynomial
/// (below) does it, of a tolerance of 1e-4 or more.
///
/// Corrections are computed in single precision, residuals and positions in double. Where single precision
/// does not suffice, all is double. Second order with the umbrella and nothing else (Q = M, C = 1, no
/// constraint, l2) is solved by a polynomial instead (chebyshev.h), several times faster.
///
/// Fixed-block reductions: the same bits for any number of threads. Positions are always finite: a breakdown
/// (a singular or indefinite system) stops at the last finite iterate and is reported. Thread safe for
/// different positions.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "smoothing/modifiers/constraint.h"
#include "smoothing/operators/operator.h"

namespace rfsmooth::smoothing {

/// When to stop.
struct SolverOptions {
  double tolerance = 1e-5;    ///< of the residual, relative to the centred right side
  bool of_start = false;      ///< of solve(): relative to the residual of the start instead
  int max_iterations = 5000;  ///< then the last iterate is returned as it is
  bool linf = false;          ///< stop on the largest instead of the root mean square residual
};

/// How it ended.
struct SolverReport {
  int iterations = 0;           ///< products with A in the iteration
  double residual = 0;          ///< at the end; relative as the tolerance is, in the norm of the options
  bool converged = false;       ///< within the tolerance, or as near as rounding lets the residual come to 0
  bool by_polynomials = false;  ///< and by nothing else; false if there was nothing to do
};

/// y = A x for a symmetric positive definite A; x and y are distinct, n rows. Returns x . y, summed in fixed
/// blocks.
using Product = std::function<double(const Positions& x, Positions& y)>;

/// The matrix of A x = b by what it does. The referenced objects must outlive the calls.
struct LinearSystem {
  Product product;                      ///< of A
  const std::vector<double>& diagonal;  ///< n: of A, positive
  const std::vector<double>& mass;      ///< n: defines the norm of the residual
};

/// Solves A x = b from the start x; hard constraints hold relative to it. Memory of 5 n-vectors.
SolverReport conjugate_gradients(const LinearSystem& system, const Positions& b, Positions& x,
                                 const AllowedMoves& allowed, const SolverOptions& options,
                                 const Context& context);

/// The system above. The referenced objects must outlive the calls.
struct Fairing {
  const Adjacency& rows;
  const Operator& op;
  std::array<double, 4> a = {0, 0, 0, 0};  ///< a_1 .. a_4, in units of op (times op.unit^k for dimensionless)
  std::vector<double> data = {};           ///< n: Q >= 0, not all zero; empty = op.mass
  std::vector<double> strength = {};       ///< n: C >= 0, of the a_2 term; empty = all 1
};

/// Solves the system for o. Starts from x if it has o's size (a warm start), else from o. Hard constraints
/// hold relative to the start. \throw std::invalid_argument if the array sizes disagree.
SolverReport solve(const Fairing& system, const Positions& o, Positions& x, const AllowedMoves& allowed,
                   const SolverOptions& options, const Context& context);

}  // namespace rfsmooth::smoothing
