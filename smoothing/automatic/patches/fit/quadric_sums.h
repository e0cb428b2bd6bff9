/// The sums of a weighted quadric fit over many points, and its values there, several points an instruction.
///
///     a = sum w f f^T,   right = sum w y f,   f = (1, u, v, u^2, u v, v^2)
///
/// Thread safe.
#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace rfsmooth::smoothing {

/// Points are taken so many at a time: arrays are to be filled up to a multiple with zeros.
inline constexpr std::size_t kLanes = 8;

/// The next multiple of kLanes.
inline std::size_t padded(std::size_t size) {
  return (size + kLanes - 1) / kLanes * kLanes;
}

/// a and right, summed in double precision.
struct QuadricSums {
  Eigen::Matrix<double, 6, 6> a;
  Eigen::Matrix<double, 6, 1> right;
};

/// \param size padded(number of points). u, v and y are of the order of one. O(size), the same bits every
/// time.
void sum_quadric(std::size_t size, const float* u, const float* v, const float* y, const float* w,
                 QuadricSums& sums);

/// What a fit says of its points, each an array.
struct QuadricSays {
  float* height;     ///< (q.f - g) c, the quadric over g along a point's own direction
  float* influence;  ///< f^T a^-1 f
};

/// How a fit and its points agree.
struct QuadricErrors {
  double residuals;  ///< sum of w ((y - q.f) c)^2
  double leverage;   ///< sum of w^2 f^T a^-1 f
};

/// Enters what the fit says of every point. \param half L^-1 of L L^T = a: with a^-1 itself, influences would
/// lose their digits where points lie in a line. O(size), the same bits every time.
QuadricErrors evaluate_quadric(std::size_t size, const float* u, const float* v, const float* y,
                               const float* w, const float* g, const float* c,
                               const Eigen::Matrix<double, 6, 1>& q, const Eigen::Matrix<double, 6, 6>& half,
                               const QuadricSays& says);

}  // namespace rfsmooth::smoothing
