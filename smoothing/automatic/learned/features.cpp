#include "smoothing/automatic/learned/features.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr float kFarResidual = 6, kFarCandidate = 5, kFarEvidence = 3;  // s, s, s^2: beyond, all is alike
/// x of either sign and any size, in (-1, 1).
float squashed(float x) {
  return x / (1 + std::abs(x));
}

/// Writes one number after the other.
class Writer {
 public:
  explicit Writer(Features::Row& row) : even_(row.even.data()), odd_(row.odd.data()) {}
  void even(float x) { *even_++ = x; }
  void odd(float x) { *odd_++ = x; }

 private:
  float *even_, *odd_;
};

/// `flat`: the weight of one flat sheet.
void write_heights(const Histogram& h, float flat, Writer& to) {
  const float all = total(h.all), unit = 1 / (all + 1e-6F);
  to.even(unit * h.bin[kSide]);
  for (std::size_t k = 1; k <= kSide; ++k) {
    to.even(unit * (h.bin[kSide + k] + h.bin[kSide - k]));
    to.odd(unit * (h.bin[kSide + k] - h.bin[kSide - k]));
  }
  to.even(all / (all + flat));
}

void write_sheets(const Sums<7>& s, Writer& to) {
  const auto [height, square, facing, against, either, same, other] = s.means();
  to.odd(height);
  to.odd(same);
  to.odd(other);
  to.even(0.25F * square);
  to.even(facing);
  to.even(against);
  to.even(either);
}

void write_moments(const Sums<9>& s, const Eigen::Vector3f& normal, Writer& to) {
  const auto [x, y, z, xx, yy, zz, xy, xz, yz] = s.means();
  const Eigen::Vector3f m(x, y, z), u(xx, xy, xz), v(xy, yy, yz), w(xz, yz, zz);  // rows of the second
  const float across = normal.dot(Eigen::Vector3f(u.dot(normal), v.dot(normal), w.dot(normal))),
              off = m.dot(normal);
  // The two eigenvalues along the surface: their sum is the rest of the trace, and their product is what
  // the adjugate is along n.
  const float half = std::max(0.0F, 0.5F * (xx + yy + zz - across));
  const float product = normal.dot(normal[0] * v.cross(w) + normal[1] * w.cross(u) + normal[2] * u.cross(v));
  const float apart = std::sqrt(std::max(0.0F, half * half - product));
  to.odd(off);
  to.even(std::sqrt(std::max(0.0F, across)) / 3);
  to.even(std::sqrt(half + apart) / 3);
  to.even(std::sqrt(std::max(0.0F, half - apart)) / 3);
  to.even(std::sqrt(std::max(0.0F, m.squaredNorm() - off * off)));
}

void write_residuals(const Sums<4>& s, Writer& to) {
  const auto [first, second, third, fourth] = s.means();
  to.odd(first);
  to.odd(third / 6);
  to.even(second);
  to.even(fourth / 6);
}

}  // namespace

Features::Features(HeightField& field, const Positions& data, const Smoothed& smoothed,
                   const rfs_mesh::NoiseField& noise, const Context& context)
    : field_(field), smoothed_(smoothed), noise_(noise) {
  constexpr int kTimes = 4;
  const auto residual = [&](std::size_t i) {
    return std::clamp((field.local()[i].height - height(i)) / unit(i), -kFarResidual, kFarResidual);
  };
  pooled_.resize(field.size());
  for_each_index(context, field.size(), [&](std::size_t i) {
    const float r = residual(i);
    const float narrow = candidate(i, float(smoothed.scales[i][0].off)),
                third = candidate(i, float(smoothed.scales[i][2].off));
    pooled_[i] << r, r * r, r * r * r / 6, r * r * r * r / 6, smoothed.own[i], narrow * narrow, third * third,
        0;
  });
  field.ready_for_means(context);
  for (int t = 0; t < kTimes; ++t) pooled_ = field.local_mean(pooled_, context);
  field.drop_weights();
  field.ready_for_searches(context);
  packed_.resize(field.size());  // only now: pooling takes as much for itself
  for_each_index(context, field.size(), [&](std::size_t i) {
    const Eigen::Vector3d& guide = field.guide()[i];
    packed_[i] = {(data[i] - guide).cast<float>(), (smoothed.place[i] - guide).cast<float>(),
                  field.local()[i].normal, residual(i)};
  });
}

float Features::candidate(std::size_t i, float off) const {
  if (std::isnan(off)) return 0;
  return std::clamp((field_.local()[i].height - height(i)) / unit(i) + off, -kFarCandidate, kFarCandidate);
}

void Features::fill(std::size_t i, Row& row, Surroundings& near) const {
  Writer to(row);
  const float s = unit(i);
  for (const ScaleSays& says : smoothed_.scales[i]) {
    to.odd(candidate(i, float(says.off)));
    to.even(float(says.own));
    to.even(std::clamp(float(says.near), -kFarEvidence, kFarEvidence));
    to.even(std::clamp(float(says.wide), -kFarEvidence, kFarEvidence));
  }
  to.odd(packed_[i].residual);
  to.odd(candidate(i, (smoothed_.mixed[i] - field_.local()[i].height) / unit(i)));
  to.even(smoothed_.own[i]);
  to.odd(pooled_[i][0]);
  to.odd(pooled_[i][2]);
  for (const Eigen::Index k : {1, 3, 4, 5, 6}) to.even(pooled_[i][k]);

  const float dense = float(s / noise_.spacing), radius = float(kSeen) * s;
  near.move_to(field_.guide()[i], double(radius));
  const auto three = [](const Eigen::Vector3f& v) { return std::array<float, 3>{v[0], v[1], v[2]}; };
  const Packed& one = packed_[i];
  Seen seen;
  see(near,
      {three((near.origin() - field_.guide()[i]).cast<float>()), three(one.place), three(one.normal), 1 / s,
       radius},
      seen);
  // A flat sheet has about one point in a square spacing; the weights over a disc of radius r sum to a third
  // of its area. Of such points one in `stride` is seen.
  const float flat = dense * dense / float(near.stride());
  write_residuals(seen.close, to);
  write_residuals(seen.wide, to);
  write_heights(seen.inner, kInner * kInner * flat, to);
  write_heights(seen.outer, kOuter * kOuter * flat, to);
  write_sheets(seen.sheets, to);
  write_moments(seen.moments, one.normal, to);
  to.even(squashed(dense));
  to.even(s / float(noise_.local[i]));
  to.even(float(smoothed_.variance));
}

}  // namespace rfsmooth::smoothing
