#include "rfs_mesh/normals/thin_parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/fit/principal_axes.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/normals/winding.h"
#include "rfs_mesh/sample.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

// Chosen on the closed development shapes at 50,000 points, without noise and after 1 %
// (tests/bench/normals).
constexpr double kOff = 0.25;      // e above which something is tried
constexpr double kMostOff = 0.3;   // share of the samples that may be: rotor's walls are 0.17
constexpr double kMostLeft = 0.4;  // of all e squared, if more are: 0.31 on rotor after 2 %, 0.52 on scans
constexpr int kMiddleCount = 64;
constexpr double kThinnest = 1e-9;  // of C's eigenvalues, beside the largest

/// Where the point i of `near`, which holds it and its neighbours, lies about their middle.
Vector3d out_of_middle(const Positions& points, std::size_t i, const std::vector<Neighbor>& near) {
  const auto [mean, axes] = principal_axes(points, near);
  const double largest = axes.values[2];
  if (!(largest > 0)) return Vector3d::Zero();
  Vector3d offset = axes.vectors.transpose() * (points[i] - mean);
  for (int axis = 0; axis < 3; ++axis) offset[axis] /= std::max(axes.values[axis] / largest, kThinnest);
  const double length = offset.norm();
  return length > 0 ? Vector3d(axes.vectors * offset / length) : Vector3d(Vector3d::Zero());
}

class ThinParts {
 public:
  ThinParts(const SpatialIndex& index, const Context& context)
      : index_(index), points_(index.points()), context_(context), row_(sample_rows(points_.size())) {
    at_ = at_rows(points_, row_, context);
    around_ = SpatialIndex(at_, context).nearest(int(kNeighbourhood), context);
    if (around_.k == 0) return;
    area_.resize(row_.size());
    for_each_index(context, row_.size(), [&](std::size_t s) {
      const Adjacency::Row row = around_[s];
      const std::size_t count = std::min(kRing, row.size());
      area_[s] = square_of_point((at_[row[count - 1]] - at_[s]).squaredNorm(), count);
    });
  }

  std::size_t turn(Positions& normals) {
    const double area = std::accumulate(area_.begin(), area_.end(), 0.0);
    if (!(area > 0)) return 0;
    const Winding winding(at_, softening_of(area, at_.size()), context_);
    Positions now = at_rows(normals, row_, context_);
    const std::vector<double> w = numbers(winding, now);
    std::vector<double> off = offness(w);
    const auto above = std::count_if(off.begin(), off.end(), [](double e) { return e > kOff; });
    const bool many = double(above) > kMostOff * double(off.size());
    if (above == 0 || !(many || closes(w))) return 0;

    const double before = squares(off);
    std::vector<double> sign(at_.size(), 0);  // with which each sample was turned last; 0: never
    for (const double side : {1, -1, 1}) {    // out of walls, out of slits, walls again
      const Positions tried = out_of_middles(off, side, now);
      const std::vector<double> then = offness(numbers(winding, tried));
      std::vector<char> better(at_.size());
      for_each_index(context_, at_.size(), [&](std::size_t s) {
        better[s] = off[s] > kOff && then[s] < off[s] && turned_around(s, now, tried) >= kLeastPart ? 1 : 0;
      });
      Positions next = now;
      for_each_index(context_, at_.size(), [&](std::size_t s) {
        if (better[s] != 0) next[s] = tried[s];
      });
      std::vector<double> left = offness(numbers(winding, next));
      if (!(squares(left) < squares(off))) continue;
      for_each_index(context_, at_.size(), [&](std::size_t s) {
        if (better[s] != 0) sign[s] = side;
      });
      now.swap(next);
      off.swap(left);
    }
    if (many && squares(off) > kMostLeft * before) return 0;
    return apply(sign, normals);
  }

 private:
  /// w at every sample.
  std::vector<double> numbers(const Winding& winding, const Positions& normals) const {
    Positions area_vectors(at_.size());
    for (std::size_t s = 0; s < at_.size(); ++s) area_vectors[s] = area_[s] * normals[s];
    return winding.numbers(area_vectors, context_);
  }

  /// Whether w is that of a closed surface but for thin parts, where it is low: what nine tenths of the
  /// samples do not exceed, and the median.
  static bool closes(std::vector<double> w) {
    return std::abs(quantile(w, 0.5) - 0.5) < kClosed && quantile(w, 0.9) - 0.5 < kClosed;
  }

  /// e of every sample.
  std::vector<double> offness(const std::vector<double>& w) const {
    std::vector<double> off(w.size());
    for_each_index(context_, w.size(), [&](std::size_t s) {
      double sum = 0;
      for (const Index t : around_[s]) {
        const double d = std::clamp(w[t] - 0.5, -1.0, 1.0);
        sum += d * d;
      }
      off[s] = std::sqrt(sum / double(around_.k));
    });
    return off;
  }

  static double squares(const std::vector<double>& v) {
    return std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
  }

  /// The normals of the samples to try: those where w is off point out of (or into) the middle of what is
  /// around them.
  Positions out_of_middles(const std::vector<double>& off, double sign, const Positions& normals) const {
    Positions tried = normals;
    for_blocks(context_, at_.size(), 256, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbor> near;
      for (std::size_t s = begin; s < end; ++s)
        if (off[s] > kOff) turn_out(row_[s], sign, near, tried[s]);
    });
    return tried;
  }

  void turn_out(std::size_t i, double sign, std::vector<Neighbor>& near, Vector3d& normal) const {
    index_.nearest(points_[i], kMiddleCount + 1, near);
    const Vector3d out = out_of_middle(points_, i, near);
    if (out.squaredNorm() > 0) normal = sign * out;
  }

  /// Turns every point as the sample that stands for it.
  std::size_t apply(const std::vector<double>& sign, Positions& normals) const {
    if (std::all_of(sign.begin(), sign.end(), [](double s) { return s == 0; })) return 0;
    const std::vector<Index> of_point = samples();
    for_blocks(context_, points_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbor> near;
      for (std::size_t i = begin; i < end; ++i)
        if (const double s = sign[of_point[i]]; s != 0) turn_out(i, s, near, normals[i]);
    });
    return std::size_t(
        std::count_if(of_point.begin(), of_point.end(), [&](Index s) { return sign[s] != 0; }));
  }

  /// The share of the samples around s that change sides. At the rim of an open sheet w is off, too, but
  /// nothing turns over.
  double turned_around(std::size_t s, const Positions& normals, const Positions& tried) const {
    const auto turns = [&](Index t) { return normals[t].dot(tried[t]) < 0 ? 1 : 0; };
    int count = turns(Index(s));
    for (const Index t : around_[s]) count += turns(t);
    return double(count) / double(around_.k + 1);
  }

  /// The sample that stands for each point: the nearest.
  std::vector<Index> samples() const {
    return at_.size() == points_.size() ? row_
                                        : nearest_points(SpatialIndex(at_, context_), points_, context_);
  }

  const SpatialIndex& index_;
  const Positions& points_;
  const Context& context_;
  std::vector<Index> row_;  ///< of each sample
  Positions at_;
  NeighborTable around_;  ///< of the samples
  std::vector<double> area_;
};

}  // namespace

std::size_t turn_out_of_thin_parts(const SpatialIndex& index, Positions& normals, const Context& context) {
  if (normals.size() != index.points().size())
    throw std::invalid_argument("turn_out_of_thin_parts: points and normals differ in number");
  return ThinParts(index, context).turn(normals);
}

}  // namespace rfsmooth::rfs_mesh
