#include "rfs_mesh/normals/bilateral_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

// Chosen on the closed development shapes at 50,000 points and 1 % noise (tests/bench/normals): more passes
// gain at sharp edges and lose on organic shapes.
constexpr int kPasses = 3;
constexpr std::size_t kJudged = 16;  // neighbours that say how calm the normals are
constexpr std::size_t kMiddle = 6;   // which of them, from the calmest
constexpr double kTolerance = 2;
constexpr std::size_t kScattered = 24;  // neighbours that say how well points lie on the surface
constexpr double kOfScatter = 230;      // radians per (r / R)^2
constexpr double kCalmest = 0.05;       // radians: what normals of a flat place may differ by
constexpr double kLeastMost = 0.02, kGreatestMost = 0.5;  // radians: bounds of the most
constexpr double kFarOut = 20;                            // exponents beyond which a neighbour says nothing

/// |n -+ m|^2: the squared angle, for small ones.
double apart(const Vector3d& n, const Vector3d& m) {
  return std::max(0.0, 2 - 2 * std::abs(n.dot(m)));
}

/// The most that each tolerance may be.
std::vector<double> limits(const Positions& points, const NeighborTable& near,
                           const std::vector<double>& scatter, const Context& context) {
  std::vector<double> limit(points.size());
  for_each_index(context, points.size(), [&](std::size_t i) {
    const Adjacency::Row row = near[i];
    const std::size_t count = std::min(kScattered, row.size());
    double sum = scatter[i];
    for (std::size_t k = 0; k < count; ++k) sum += scatter[row[k]];
    const double r = sum / double(count + 1), square = (points[row[count - 1]] - points[i]).squaredNorm();
    limit[i] =
        square > 0 ? std::clamp(kOfScatter * r * r / square, kLeastMost, kGreatestMost) : kGreatestMost;
  });
  return limit;
}

double tolerance_at(std::size_t i, Adjacency::Row row, const Positions& normals, double most) {
  std::array<double, kJudged> squares{};
  const std::size_t count = std::min(kJudged, row.size());
  for (std::size_t k = 0; k < count; ++k) squares[k] = apart(normals[i], normals[row[k]]);
  const auto middle = squares.begin() + std::ptrdiff_t(kMiddle * count / kJudged);
  std::nth_element(squares.begin(), middle, squares.begin() + std::ptrdiff_t(count));
  return std::min(std::max(kCalmest, kTolerance * std::sqrt(*middle)), most);
}

Vector3d filtered(std::size_t i, const Positions& points, Adjacency::Row row, const Positions& normals,
                  double most) {
  const double square = 1.1 * (points[row[row.size() - 1]] - points[i]).squaredNorm();
  if (!(square > 0)) return normals[i];
  const double tolerance = tolerance_at(i, row, normals, most);
  Vector3d sum = normals[i];
  for (const Index j : row) {
    const double unlike = apart(normals[i], normals[j]) / (2 * tolerance * tolerance);
    if (unlike > kFarOut) continue;
    const double near = 1 - (points[j] - points[i]).squaredNorm() / square;
    const double weight = near * near * std::exp(-unlike);
    sum += (normals[i].dot(normals[j]) < 0 ? -weight : weight) * normals[j];
  }
  return sum.normalized();  // at least as long as the unit vector it starts from
}

}  // namespace

void bilateral_normals(const Positions& points, const NeighborTable& near, const std::vector<double>& scatter,
                       Positions& normals, const Context& context) {
  if (normals.size() != points.size() || scatter.size() != points.size() ||
      (near.k > 0 && near.size() != points.size()))
    throw std::invalid_argument(
        "bilateral_normals: points, neighbours, scatter and normals differ in number");
  if (near.k == 0) return;
  const std::vector<double> most = limits(points, near, scatter, context);
  Positions next(normals.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    for_each_index(context, normals.size(),
                   [&](std::size_t i) { next[i] = filtered(i, points, near[i], normals, most[i]); });
    normals.swap(next);
  }
}

}  // namespace rfsmooth::rfs_mesh
