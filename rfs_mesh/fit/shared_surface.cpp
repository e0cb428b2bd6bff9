#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "rfs_mesh/fit/local_surface.h"
#include "rfs_mesh/fit/quadric.h"
#include "rfs_mesh/fit/scatter.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/groups.h"
#include "rfs_mesh/search/wide_neighbors.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Vector3d;

/// A quadric per this share of its points: every point then lies in about twelve of them. With fewer, 1/10,
/// points with noise of 3 % of the size came to lie 0.6 % farther from the truth (Chamfer distance).
constexpr double kPointsPerSeed = 1.0 / 12;
/// Where m is small: with 8 surfaces at noise of half a spacing were worse than from a quadric for each
/// point.
constexpr std::size_t kFewestInGroup = 7;
constexpr double kMisfit = 1.4;  ///< residual over noise: well above what that of pure noise scatters
/// A quadric's tangent plane is surest at its centre, and the quadrics of a point lie on all sides of it: its
/// normal is the mean of theirs a third of the way. On spheres with noise of 0.5 to 2 spacings that is nearer
/// the truth than a quadric of the point's own, and than the whole way.
constexpr double kTurn = 1.0 / 3;
/// Less weight than that of one quadric near whose rim the point lies: the point is fitted by itself.
constexpr double kLeastWeight = 0.01;

/// Fits quadrics around points of an index.
class Fitter {
 public:
  Fitter(const SpatialIndex& index, const NoiseScale& scale, const std::vector<double>& noise,
         const std::vector<Index>& wider, std::size_t least)
      : index_(index), noise_(noise), wider_(wider), least_(least), near_(index, scale.neighbours + 1) {}

  /// Around point i, with neighbourhoods halved until they are flat enough.
  Quadric fit(Index i) {
    const Positions& points = index_.points();
    if (wider_.empty())
      near_.find(points[i]);
    else
      near_.find(points[i], wider_[i] + 1);
    row_.clear();
    for (std::size_t k = 0; k < near_.size(); ++k)
      if (near_.index()[k] != i) row_.push_back(near_.index()[k]);
    std::size_t count = row_.size();
    const double most = kMisfit * noise_[i];
    Quadric quadric = fit_quadric(points, points[i], row_.data(), count, workspace_);
    if (quadric.residual > most && count / 2 >= least_) sort(points, points[i]);
    while (quadric.residual > most && count / 2 >= least_)
      quadric = fit_quadric(points, points[i], row_.data(), count /= 2, workspace_);
    return quadric;
  }

 private:
  void sort(const Positions& points, const Vector3d& p) {
    found_.clear();
    for (const Index j : row_) found_.push_back({j, squared_distance(points[j], p)});
    std::sort(found_.begin(), found_.end());
    for (std::size_t k = 0; k < row_.size(); ++k) row_[k] = found_[k].index;
  }

  const SpatialIndex& index_;
  const std::vector<double>& noise_;
  const std::vector<Index>& wider_;
  std::size_t least_;
  QuadricWorkspace workspace_;
  WideNeighbors near_;
  std::vector<Neighbor> found_;
  std::vector<Index> row_;
};

/// The cloud in compact groups of neighbouring points, a quadric around the point in the middle of each.
class SharedQuadrics {
 public:
  SharedQuadrics(const SpatialIndex& index, const NeighborTable& near, const NoiseScale& scale,
                 const std::vector<double>& noise, const std::vector<Index>& wider, std::size_t least,
                 const Context& context)
      : index_(index), noise_(noise), group_(index.points().size()) {
    const auto members = std::max(kFewestInGroup, std::size_t(kPointsPerSeed * double(scale.neighbours)));
    const Adjacency groups = group_around_kept(index.points(), near, members, context);
    quadrics_.resize(groups.size());
    // The first search of a fitter is the dearest: it guesses no radius.
    for_blocks(context, groups.size(), 64, [&](std::size_t begin, std::size_t end) {
      Fitter fitter(index, scale, noise, wider, least);
      for (std::size_t g = begin; g < end; ++g) {
        for (const Index i : groups[g]) group_[i] = Index(g);
        quadrics_[g] = fitter.fit(middle(groups[g]));
      }
    });
  }

  /// What the quadrics of the groups of point i and of its neighbours agree on. False if they say nothing.
  bool surface(Index i, Adjacency::Row near, std::vector<Index>& around, LocalSurface& surface) const {
    around.assign(1, group_[i]);
    for (const Index j : near)
      if (std::find(around.begin(), around.end(), group_[j]) == around.end()) around.push_back(group_[j]);
    const Vector3d& p = index_.points()[i];
    const double sigma = noise_[i];
    double total = 0, agreement = 0, residual = 0;
    Vector3d normal = Vector3d::Zero(), shift = Vector3d::Zero();
    for (const Index g : around) {
      const Quadric& q = quadrics_[g];
      if (q.radius == 0) continue;
      const Vector3d d = (p - q.centre) / q.radius;
      const double inside = 1 - d.squaredNorm();
      if (inside <= 0) continue;
      const double u = q.t1.dot(d), v = q.t2.dot(d), above = q.n.dot(d) - q.height(u, v);
      const double scatter = std::max(q.residual, sigma), off = std::pow(above * q.radius / scatter, 2);
      if (off > kScatterWindow * kScatterWindow) continue;  // another sheet
      const double clear = std::pow(sigma / scatter, 2);    // 1 where the quadric shows noise alone
      const double trust = inside * (clear * clear) * std::exp(-0.5 * off);
      const double weight = inside * inside * trust;
      // The normal over (u, v) is (n - a t1 - b t2) / sqrt(1 + a^2 + b^2), and so is the turned one.
      const auto slope = [&q](double at_u, double at_v) {
        return Eigen::Vector2d(q.c[1] + 2 * q.c[3] * at_u + q.c[4] * at_v,
                               q.c[2] + q.c[4] * at_u + 2 * q.c[5] * at_v);
      };
      const Eigen::Vector2d here = slope(u, v), turned = slope(kTurn * u, kTurn * v);
      const double lift = weight * above * q.radius / (1 + here.squaredNorm());
      shift -= lift * (q.n - here[0] * q.t1 - here[1] * q.t2);
      const Vector3d way = q.n - turned[0] * q.t1 - turned[1] * q.t2;
      const double length = trust / std::sqrt(1 + turned.squaredNorm());
      normal += (way.dot(normal) < 0 ? -length : length) * way;
      agreement += trust;
      total += weight;
      residual += weight * q.residual;
    }
    if (total < kLeastWeight || normal.norm() < 0.5 * agreement) return false;
    surface = {normal.normalized(), p + shift / total, residual / total};
    return true;
  }

 private:
  /// The point nearest to the mean.
  Index middle(Adjacency::Row group) const {
    const Positions& points = index_.points();
    Vector3d sum = Vector3d::Zero();
    for (const Index i : group) sum += points[i];
    const Vector3d mean = sum / double(group.size());
    Neighbor nearest = {kNone, std::numeric_limits<double>::infinity()};
    for (const Index i : group) nearest = std::min(nearest, {i, squared_distance(points[i], mean)});
    return nearest.index;
  }

  const SpatialIndex& index_;
  const std::vector<double>& noise_;
  std::vector<Quadric> quadrics_;
  std::vector<Index> group_;  // n
};

}  // namespace

std::vector<LocalSurface> shared_local_surfaces(const SpatialIndex& index, const NeighborTable& near,
                                                const NoiseScale& scale, const std::vector<double>& noise,
                                                const std::vector<Index>& wider, std::size_t least,
                                                const Context& context) {
  const SharedQuadrics quadrics(index, near, scale, noise, wider, least, context);
  std::vector<LocalSurface> surfaces(index.points().size());
  for_blocks(context, surfaces.size(), 1024, [&](std::size_t begin, std::size_t end) {
    Fitter fitter(index, scale, noise, wider, least);
    std::vector<Index> around;
    for (std::size_t i = begin; i < end; ++i)
      if (!quadrics.surface(Index(i), near[i], around, surfaces[i]))
        surfaces[i] = surface_at_centre(fitter.fit(Index(i)));
  });
  return surfaces;
}

}  // namespace rfsmooth::rfs_mesh
