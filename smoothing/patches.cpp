#include "rfsmooth/smoothing/patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/smoothing/thinning.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kMostOver = 16;  // patches over a point: more only cost time
constexpr std::size_t kAxis = 12;      // nearest points whose normals make the patch's axis
constexpr double kCovered = 0.2;       // least weight of the best patch over a point

}  // namespace

Patches::Features Patches::features(const Patch& patch, const Eigen::Vector3d& r) {
  const double u = r.dot(patch.u), v = r.dot(patch.v);  // the frame is in units of the radius
  return (Features() << 1, u, v, u * u, u * v, v * v).finished();
}

Patches::Patches(const HeightField& field, std::size_t members, std::vector<Index> seeds,
                 const std::vector<double>& sigma, const Context& context)
    : field_(field), members_(std::min(members, field.size())), seeds_(std::move(seeds)) {
  reach_ =
      std::clamp<std::size_t>((members_ * seeds_.size() + field.size() - 1) / field.size(), 1, kMostOver);
  over_.assign(field_.size() * reach_, kNone);
  over_weight_.assign(field_.size() * reach_, 0);
  fit(0, seeds_.size(), sigma, context);
  std::vector<Index> all(field_.size());
  std::iota(all.begin(), all.end(), Index{0});
  cover(all, context);
  // A place between sheets or at the end of something thin may be in no patch, or only at the rim of one.
  const std::vector<Index> missing = uncovered();
  if (missing.empty()) return;
  const std::size_t first = seeds_.size();
  const std::vector<Index> more = thin(field.guide(), missing, context);
  seeds_.insert(seeds_.end(), more.begin(), more.end());
  fit(first, seeds_.size(), sigma, context);
  cover(missing, context);
}

void Patches::fit(std::size_t first, std::size_t last, const std::vector<double>& sigma,
                  const Context& context) {
  patches_.resize(last);
  member_.resize(last * members_);
  member_weight_.resize(last * members_);
  for_blocks(context, last - first, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<rfs_mesh::Neighbor> near;
    for (std::size_t s = first + begin; s < first + end; ++s) fit_one(s, sigma, near);
  });
}

void Patches::fit_one(std::size_t s, const std::vector<double>& sigma,
                      std::vector<rfs_mesh::Neighbor>& near) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  const Index seed = seeds_[s];
  const auto& guide = field_.guide();
  const auto& normals = field_.normals();
  Patch& patch = patches_[s];
  field_.index().nearest(guide[seed], int(members_), near);
  patch.centre = guide[seed];
  patch.axis = normals[seed];
  for (std::size_t k = 0; k < std::min(near.size(), kAxis); ++k) {
    const Eigen::Vector3d& n = normals[near[k].index];
    if (same_sheet(n, normals[seed]) == 0) continue;
    patch.axis += n;
  }
  patch.axis.normalize();
  // A little beyond the farthest point, so that it counts.
  patch.square = std::max(1.1 * near.back().squared_distance, std::numeric_limits<double>::min());
  const double radius = std::sqrt(patch.square);
  patch.u = patch.axis.unitOrthogonal();
  patch.v = patch.axis.cross(patch.u) / radius;
  patch.u /= radius;

  float* const weights = member_weight_.data() + s * members_;
  Index* const indices = member_.data() + s * members_;
  Matrix6 system = Matrix6::Zero();
  Features right = Features::Zero();
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const auto& q = near[k];
    const double inside = 1 - q.squared_distance / patch.square, cosine = patch.axis.dot(normals[q.index]);
    const double w = same_sheet(patch.axis, normals[q.index]) * inside * inside;
    indices[k] = q.index;
    weights[k] = float(w);
    if (w == 0) continue;
    const Eigen::Vector3d r = guide[q.index] - patch.centre;
    const Features f = features(patch, r);
    system.selfadjointView<Eigen::Lower>().rankUpdate(f, w);
    right += w * (r.dot(patch.axis) + field_.heights()[q.index] / cosine) * f;
    sum += w;
    squares += w * w;
  }
  // Few points, or points in a line, leave the quadric undetermined: the ridge makes it flat there.
  system.diagonal().array() += 1e-9 * system(0, 0) + 1e-12;
  const Matrix6 inverse = system.selfadjointView<Eigen::Lower>().llt().solve(Matrix6::Identity());
  const Features quadric = inverse * right;
  std::size_t at = 0;
  for (int a = 0; a < 6; ++a) {
    patch.quadric[std::size_t(a)] = float(quadric[a] / radius);
    for (int b = 0; b <= a; ++b) patch.inverse[at++] = float(inverse(a, b));
  }

  double residuals = 0, leverage = 0;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const double w = weights[k];
    if (w == 0) continue;
    const Index i = indices[k];
    const Eigen::Vector3d r = guide[i] - patch.centre;
    const Features f = features(patch, r);
    const double cosine = patch.axis.dot(normals[i]);
    const double e = ((r.dot(patch.axis) - quadric.dot(f)) * cosine + field_.heights()[i]) / sigma[i];
    residuals += w * e * e;
    leverage += w * w * f.dot(inverse * f);
  }
  if (!(sum > 0)) {
    patch.weight = 0;
    return;
  }
  const double points = sum * sum / squares, v = 6 / points;
  const double excess = (residuals - (sum - leverage)) / sum - std::sqrt(2 / points);
  patch.weight = v / (v + std::max(0.0, excess));
}

void Patches::cover(const std::vector<Index>& points, const Context& context) {
  Positions centres(patches_.size());
  for (std::size_t s = 0; s < patches_.size(); ++s) centres[s] = patches_[s].centre;
  const rfs_mesh::SpatialIndex index(centres, context);
  for_blocks(context, points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<rfs_mesh::Neighbor> near;
    for (std::size_t p = begin; p < end; ++p) {
      const Index i = points[p];
      index.nearest(field_.guide()[i], int(reach_), near);
      for (std::size_t k = 0; k < near.size(); ++k) {
        const Patch& patch = patches_[near[k].index];
        const double inside = std::max(0.0, 1 - near[k].squared_distance / patch.square);
        over_[std::size_t(i) * reach_ + k] = near[k].index;
        over_weight_[std::size_t(i) * reach_ + k] =
            float(inside * inside * same_sheet(patch.axis, field_.normals()[i]));
      }
    }
  });
}

std::vector<Index> Patches::uncovered() const {
  std::vector<Index> missing;
  for (std::size_t i = 0; i < field_.size(); ++i) {
    const auto first = over_weight_.begin() + std::ptrdiff_t(i * reach_);
    if (*std::max_element(first, first + std::ptrdiff_t(reach_)) < kCovered) missing.push_back(Index(i));
  }
  return missing;
}

Prediction Patches::predict(const Context& context) const {
  const std::size_t n = field_.size();
  Prediction p{std::vector<double>(n, 0), std::vector<double>(n, 0), std::vector<char>(n, 0)};
  for_each_index(context, n, [&](std::size_t i) {
    double height = 0, own = 0, weights = 0;
    for (std::size_t k = i * reach_; k < (i + 1) * reach_; ++k) {
      const double e = over_weight_[k];
      if (e == 0) continue;
      const Patch& patch = patches_[over_[k]];
      const double w = e * patch.weight;
      const Eigen::Vector3d r = field_.guide()[i] - patch.centre;
      const Features f = features(patch, r);
      double value = 0, spread = 0;
      std::size_t at = 0;
      for (int a = 0; a < 6; ++a) {
        value += f[a] * patch.quadric[std::size_t(a)];
        for (int b = 0; b < a; ++b) spread += 2 * f[a] * f[b] * patch.inverse[at++];
        spread += f[a] * f[a] * patch.inverse[at++];
      }
      height +=
          w * (value * std::sqrt(patch.square) - r.dot(patch.axis)) * patch.axis.dot(field_.normals()[i]);
      own += w * e * spread;
      weights += w;
    }
    if (!(weights > 0)) return;
    p.height[i] = height / weights;
    p.own[i] = own / weights;
    p.covered[i] = 1;
  });
  return p;
}

std::vector<double> Patches::mean(const std::vector<double>& values, const Context& context) const {
  std::vector<double> of_patch(patches_.size(), 0), mean = values;
  for_each_index(
      context, patches_.size(),
      [&](std::size_t s) {
        double sum = 0, weights = 0;
        for (std::size_t k = s * members_; k < (s + 1) * members_; ++k) {
          sum += double(member_weight_[k]) * values[member_[k]];
          weights += member_weight_[k];
        }
        if (weights > 0) of_patch[s] = sum / weights;
      },
      64);
  for_each_index(context, field_.size(), [&](std::size_t i) {
    double sum = 0, weights = 0;
    for (std::size_t k = i * reach_; k < (i + 1) * reach_; ++k) {
      if (over_weight_[k] == 0) continue;
      sum += double(over_weight_[k]) * of_patch[over_[k]];
      weights += over_weight_[k];
    }
    if (weights > 0) mean[i] = sum / weights;
  });
  return mean;
}

}  // namespace rfsmooth::smoothing
