#include "rfs_mesh/normals/bilateral_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "base/parallel.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

// Chosen on the closed development shapes at 50,000 points and 1 % noise (tests/bench/normals): more passes
// gain at sharp edges and lose on organic shapes.
constexpr int kPasses = 3;
constexpr std::size_t kMiddle = 6;  // which of kNarrowestPatch neighbours, from the calmest, says how calm
constexpr double kTolerance = 2;
constexpr double kOfScatter = 230;  // radians per (r / R)^2
// Radians: bounds of what normals of one place may differ by.
constexpr double kCalmest = 0.02, kWildest = 0.5;

constexpr std::size_t kNormalLanes = 8;  // numbers side by side in registers
using NormalLanes = Eigen::Array<float, int(kNormalLanes), 1>;

/// A point and its normal, side by side in memory. Single precision is far finer than the calmest angle.
struct Oriented {
  Vector3d at;
  Eigen::Vector3f normal;
};

/// |n -+ m|^2, which is that for small ones.
float squared_angle(const Eigen::Vector3f& n, const Eigen::Vector3f& m) {
  return std::min((n - m).squaredNorm(), (n + m).squaredNorm());
}

/// exp(-x) but for its far end: (1 - x / 16)^16, which needs no library and ends at 16.
NormalLanes fading(const NormalLanes& x) {
  return (1 - x / 16).max(0).square().square().square().square();
}

/// The most that each tolerance may be.
std::vector<double> limits(const Positions& points, const NeighborTable& near,
                           const std::vector<double>& scatter, const Context& context) {
  std::vector<double> limit(points.size());
  for_each_index(context, points.size(), [&](std::size_t i) {
    const Adjacency::Row row = near[i];
    const std::size_t count = std::min(kNeighbourhood, row.size());
    double sum = scatter[i];
    for (std::size_t k = 0; k < count; ++k) sum += scatter[row[k]];
    const double r = sum / double(count + 1), square = (points[row[count - 1]] - points[i]).squaredNorm();
    limit[i] = square > 0 ? std::clamp(kOfScatter * r * r / square, kCalmest, kWildest) : kWildest;
  });
  return limit;
}

float tolerance_at(const Oriented& here, Adjacency::Row row, const std::vector<Oriented>& all, double most) {
  std::array<float, kNarrowestPatch> squares{};
  const std::size_t count = std::min(kNarrowestPatch, row.size());
  for (std::size_t k = 0; k < count; ++k) squares[k] = squared_angle(here.normal, all[row[k]].normal);
  const auto middle = squares.begin() + std::ptrdiff_t(kMiddle * count / kNarrowestPatch);
  std::nth_element(squares.begin(), middle, squares.begin() + std::ptrdiff_t(count));
  return float(std::min(std::max(kCalmest, kTolerance * std::sqrt(double(*middle))), most));
}

/// The neighbours of a point by coordinate, padded to whole lanes with such of no weight.
struct Ring {
  std::vector<float> d, nx, ny, nz;  // squared distance over that of the rim; normal

  void gather(const Oriented& here, Adjacency::Row row, const std::vector<Oriented>& all, double per_square) {
    const std::size_t padded = (row.size() + kNormalLanes - 1) / kNormalLanes * kNormalLanes;
    d.assign(padded, 1);
    for (auto* const n : {&nx, &ny, &nz}) n->resize(padded);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const Oriented& other = all[row[k]];
      d[k] = float(per_square * (other.at - here.at).squaredNorm());
      nx[k] = other.normal[0];
      ny[k] = other.normal[1];
      nz[k] = other.normal[2];
    }
  }
};

/// The weighted sum of the ring's normals, each turned to the side of n. Lanes are added up in one order.
Vector3d weighted_sum(const Ring& ring, const Eigen::Vector3f& n, float per_unlike) {
  NormalLanes x = NormalLanes::Zero(), y = x, z = x;
  for (std::size_t first = 0; first < ring.d.size(); first += kNormalLanes) {
    const auto at = [first](const std::vector<float>& of) {
      return Eigen::Map<const NormalLanes>(of.data() + first);
    };
    const NormalLanes a = at(ring.nx), b = at(ring.ny), c = at(ring.nz);
    const NormalLanes cosine = n[0] * a + n[1] * b + n[2] * c;
    const NormalLanes turn = (cosine < 0).select(NormalLanes::Constant(-1), NormalLanes::Ones());
    const NormalLanes unlike =
        per_unlike * ((n[0] - turn * a).square() + (n[1] - turn * b).square() + (n[2] - turn * c).square());
    const NormalLanes weight = turn * (1 - at(ring.d)).square() * fading(unlike);
    x += weight * a;
    y += weight * b;
    z += weight * c;
  }
  const auto total = [](const NormalLanes& lanes) {
    double sum = 0;
    for (const float lane : lanes) sum += double(lane);
    return sum;
  };
  return {total(x), total(y), total(z)};
}

Vector3d filtered(const Vector3d& normal, const Oriented& here, Adjacency::Row row,
                  const std::vector<Oriented>& all, double most, Ring& ring) {
  const double square = kBeyond * (all[row[row.size() - 1]].at - here.at).squaredNorm();
  if (!(square > 0)) return normal;
  const float tolerance = tolerance_at(here, row, all, most);
  ring.gather(here, row, all, 1 / square);
  return (normal + weighted_sum(ring, here.normal, 1 / (2 * tolerance * tolerance)))
      .normalized();  // at least as long as the unit vector it starts from
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
  std::vector<Oriented> all(points.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    for_each_index(context, all.size(), [&](std::size_t i) {
      all[i] = {points[i], normals[i].cast<float>()};
    });
    for_blocks(context, all.size(), 1024, [&](std::size_t begin, std::size_t end) {
      Ring ring;
      for (std::size_t i = begin; i < end; ++i)
        normals[i] = filtered(normals[i], all[i], near[i], all, most[i], ring);
    });
  }
}

}  // namespace rfsmooth::rfs_mesh
