#include "smoothing/automatic/patches/fit/patch_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "base/linear/small_cholesky.h"
#include "rfs_mesh/fit/scatter.h"
#include "smoothing/automatic/patches/fit/quadric_sums.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kAxis = 12;   // nearest points whose normals make the patch's axis
constexpr float kRounded = 0.5F;    // added before a weight is cut to a whole number
constexpr double kOnePlace = 1e-6;  // sigma: members of so small a patch are one place; it is flat
constexpr double kRough = 0.1;      // excess, sigma^2, above which there is more than one sheet

/// The directions of a patch's u and v, unit; v zero where only u is fitted over.
struct PatchAxes {
  Eigen::Vector3d u, v;
};

PatchAxes patch_axes(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d u = axis.unitOrthogonal();
  return {u, axis.cross(u)};
}

/// u along the line that the members lie on, if they do. The v of such members would only tell how far noise
/// carried each of them, as their heights do: a fit over it would follow the noise.
PatchAxes along_line(const rfs_mesh::WideNeighbors& near, const Eigen::Vector3d& axis, float square) {
  const auto [u, v] = patch_axes(axis);
  const Eigen::Vector3f first = u.cast<float>(), second = v.cast<float>();
  float uu = 0, uv = 0, vv = 0;
  for (std::size_t k = 0; k < near.size(); ++k) {
    const Eigen::Vector3f r(near.x()[k], near.y()[k], near.z()[k]);
    const float a = first.dot(r), b = second.dot(r), inside = 1 - near.squared()[k] / square;
    uu += inside * inside * a * a;
    uv += inside * inside * a * b;
    vv += inside * inside * b * b;
  }
  const float middle = (uu + vv) / 2, apart = std::hypot((uu - vv) / 2, uv);
  if (middle - apart > float(rfs_mesh::kLine) * (middle + apart)) return {u, v};
  const double turn = std::atan2(2 * double(uv), double(uu - vv)) / 2;
  return {std::cos(turn) * u + std::sin(turn) * v, Eigen::Vector3d::Zero()};
}

}  // namespace

PatchFit::PatchFit(const HeightField& field, std::size_t members)
    : field_(field), members_(members), near_(field.index(), members), point_(members), weight_(members) {
  for (std::vector<float>* values : {&u_, &v_, &guide_, &data_, &exact_weight_, &cosine_, &said_, &own_})
    values->resize(padded(members));
}

/// The mean normal about a seed, unit.
Eigen::Vector3d PatchFit::axis_at(Index seed) const {
  const std::vector<HeightField::Local>& local = field_.local();
  const Eigen::Vector3f own = local[seed].normal;
  Eigen::Vector3f sum_of_normals = 2 * own;
  for (const Index j : field_.neighbors().first_of(seed, kAxis - 1))
    if (const Eigen::Vector3f& n = local[j].normal; same_sheet(n.dot(own)) > 0) sum_of_normals += n;
  return sum_of_normals.cast<double>().normalized();
}

/// The members, and where they are in the patch's frame.
void PatchFit::gather(Index seed, double sigma) {
  near_.find(field_.guide()[seed]);
  const Eigen::Vector3d axis = axis_at(seed);
  // A little beyond the farthest point, so that it counts.
  const float square =
      std::max(float(rfs_mesh::kBeyond) * near_.farthest(), std::numeric_limits<float>::min());
  const PatchAxes flat = field_.on_lines() ? along_line(near_, axis, square) : patch_axes(axis);
  float shrink = 1 / std::sqrt(square);  // from the lengths of `near_` to radii
  radius_ = near_.unit() / double(shrink);
  if (radius_ < kOnePlace * sigma) {
    radius_ = kOnePlace * sigma;
    shrink = float(near_.unit() / radius_);
  }
  const Eigen::Vector3f along = axis.cast<float>(), u = flat.u.cast<float>() * shrink,
                        v = flat.v.cast<float>() * shrink, up = along * shrink;
  const auto in_radii = float(1 / radius_);
  size_ = 0;
  sum_ = squares_ = 0;
  for (std::size_t k = 0; k < members_; ++k) {
    const HeightField::Local& here = field_.local()[near_.index()[k]];
    const float cosine = along.dot(here.normal), inside = 1 - near_.squared()[k] / square,
                w = same_sheet(cosine) * inside * inside;
    const auto kept = MemberWeight(w * kMemberUnit + kRounded);
    if (kept == 0) continue;
    const Eigen::Vector3f r(near_.x()[k], near_.y()[k], near_.z()[k]);
    point_[size_] = near_.index()[k];
    weight_[size_] = kept;
    u_[size_] = u.dot(r);
    v_[size_] = v.dot(r);
    guide_[size_] = up.dot(r);
    data_[size_] = guide_[size_] + here.height * in_radii / cosine;
    exact_weight_[size_] = w;
    cosine_[size_] = cosine;
    ++size_;
    sum_ += double(w);
    squares_ += double(w) * double(w);
  }
  for (std::vector<float>* values : {&u_, &v_, &guide_, &data_, &exact_weight_, &cosine_})
    std::fill(values->begin() + std::ptrdiff_t(size_), values->begin() + std::ptrdiff_t(padded(size_)), 0);
}

void PatchFit::fit(Index seed, double sigma) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  say_ = 0;
  several_ = false;
  gather(seed, sigma);
  if (size_ == 0) return;
  const std::size_t size = padded(size_);
  QuadricSums sums;
  sum_quadric(size, u_.data(), v_.data(), data_.data(), exact_weight_.data(), sums);
  // Few points, or points in a line, leave the quadric undetermined: the ridge makes it flat there.
  Matrix6 system = sums.a;
  system.diagonal().array() += 1e-9 * system(0, 0) + 1e-12;
  const Matrix6 half = SmallCholesky<6>(system).inverse_factor();
  const Vector6 quadric = half.transpose() * (half * sums.right);
  const QuadricErrors errors =
      evaluate_quadric(size, u_.data(), v_.data(), data_.data(), exact_weight_.data(), guide_.data(),
                       cosine_.data(), quadric, half, {said_.data(), own_.data()});
  for (std::size_t k = 0; k < size_; ++k) said_[k] *= float(radius_);
  const double in_sigma = radius_ / sigma, residuals = in_sigma * in_sigma * errors.residuals;
  const double points = sum_ * sum_ / squares_, variance = 6 / points;
  const double excess = (residuals - (sum_ - errors.leverage)) / sum_ - std::sqrt(2 / points);
  several_ = excess > kRough;
  say_ = float(variance / (variance + std::max(0.0, excess)));
}

}  // namespace rfsmooth::smoothing
