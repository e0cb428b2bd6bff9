/// Constraints on vertices, for every flow: hard ones (fixed, on an axis, in a plane) and soft ones (a
/// strength per vertex).
///
/// Desbrun et al. 1999, section 2.7; fixed vertices are Vollmer's V_fix (section 2). Explicit moves, and each
/// part step of flows that have several, are projected and scaled. Implicit flows project inside the solver
/// and take the strength s as a mass 1 / s of the data: this is the paper's variable lambda, and keeps the
/// system symmetric. Const functions are thread safe; a flow is for one thread at a time.
#pragma once

#include <memory>
#include <vector>

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// The moves that the constraints allow each vertex.
class AllowedMoves {
 public:
  AllowedMoves() = default;

  /// \throw std::invalid_argument for a vertex >= n, two constraints on one vertex, a zero or non-finite
  /// direction, a strength outside [0, 1], or a strength array that is neither empty nor of size n.
  AllowedMoves(const Constraints& constraints, std::size_t n);

  bool all_free() const { return kind_.empty(); }

  /// The part of a move of vertex i that its hard constraint allows. Zero for fixed vertices.
  Eigen::Vector3d operator()(std::size_t i, const Eigen::Vector3d& move) const {
    return kind_.empty() ? move : projected(i, move);
  }

  /// Whether any vertex has another strength than 1.
  bool has_strengths() const { return !strength_.empty(); }

  /// The strength of vertex i: 1 = moves freely, 0 = stays.
  double strength(std::size_t i) const { return strength_.empty() ? 1 : strength_[i]; }

 private:
  Eigen::Vector3d projected(std::size_t i, const Eigen::Vector3d& move) const;

  enum class Kind : unsigned char { free, fixed, axis, plane };
  std::vector<Kind> kind_;  ///< empty: no hard constraint and no zero strength
  std::vector<Eigen::Vector3d> direction_;
  std::vector<double> strength_;  ///< empty: all 1
};

/// Wraps an explicit flow: after each step, p = q + s P (p - q). Fixed vertices keep their bits.
std::unique_ptr<Flow> make_constrained(std::unique_ptr<Flow> inner, AllowedMoves allowed);

}  // namespace rfsmooth::smoothing
