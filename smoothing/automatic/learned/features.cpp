#include "smoothing/automatic/learned/features.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr float kFarResidual = 6, kFarCandidate = 5, kFarEvidence = 3;  // s, s, s^2: beyond, all is alike
constexpr double kSeen = 6.5;                                           // s: the ball around the guide
constexpr float kInner = 3, kOuter = 6, kAround = 5, kMoments = 6;      // s: radii of discs and balls
constexpr std::size_t kSide = 6;                                        // bins on either side
constexpr float kBin = 0.75F;                                           // s

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

/// So many neighbours are looked at side by side.
using SideBySide = Eigen::Array<float, 8, 1>;
constexpr std::size_t kSideBySide = SideBySide::SizeAtCompileTime;

/// (1 - x)^2 below 1.
SideBySide biweight(const SideBySide& x) {
  return (1 - x).max(0.0F).square();
}

SideBySide same_sheet(const SideBySide& cosine) {
  return (cosine < float(rfs_mesh::kSameSheet)).select(0.0F, cosine.square());
}

/// Heights of points in bins, each shared by the two nearest.
struct Histogram {
  std::array<float, 2 * kSide + 1> bin{};
  SideBySide all = SideBySide::Zero();

  void add(const SideBySide& height, const SideBySide& weight) {
    const SideBySide at = height * (1 / kBin) + float(kSide);
    all += weight;
    for (Eigen::Index i = 0; i < Eigen::Index(kSideBySide); ++i) {
      if (!(weight[i] > 0 && at[i] >= 0 && at[i] < float(2 * kSide))) continue;
      const auto k = std::size_t(at[i]);
      const float part = at[i] - float(k);
      bin[k] += weight[i] * (1 - part);
      bin[k + 1] += weight[i] * part;
    }
  }

  /// `flat`: the weight of one flat sheet.
  void write(float flat, Writer& to) const {
    const float weights = all.sum(), unit = 1 / (weights + 1e-6F);
    to.even(unit * bin[kSide]);
    for (std::size_t k = 1; k <= kSide; ++k) {
      to.even(unit * (bin[kSide + k] + bin[kSide - k]));
      to.odd(unit * (bin[kSide + k] - bin[kSide - k]));
    }
    to.even(weights / (weights + flat));
  }
};

/// Weighted sums of N numbers, and of the weights.
template <std::size_t N>
struct Sums {
  SideBySide all = SideBySide::Zero();
  std::array<SideBySide, N> sum;

  Sums() { sum.fill(SideBySide::Zero()); }

  template <class... Numbers>
  void add(const SideBySide& weight, const Numbers&... numbers) {
    static_assert(sizeof...(numbers) == N);
    all += weight;
    std::size_t k = 0;
    ((sum[k++] += weight * numbers), ...);
  }

  /// The means.
  std::array<float, N> means() const {
    const float unit = 1 / (all.sum() + 1e-6F);
    std::array<float, N> mean;
    for (std::size_t k = 0; k < N; ++k) mean[k] = unit * sum[k].sum();
    return mean;
  }
};

/// The smoothed points around one, and how they face.
struct Sheets {
  Sums<7> sums;

  void add(const SideBySide& at, const SideBySide& cosine, const SideBySide& weight) {
    const SideBySide along = cosine.max(0.0F), away = (-cosine).max(0.0F);
    sums.add(weight, at, at.square(), along, away, cosine.square(), along * at, away * at);
  }

  void write(Writer& to) const {
    const auto [height, square, facing, against, either, same, other] = sums.means();
    to.odd(height);
    to.odd(same);
    to.odd(other);
    to.even(0.25F * square);
    to.even(facing);
    to.even(against);
    to.even(either);
  }
};

/// Moments of the data up to the second.
struct Moments {
  Sums<9> sums;

  void add(const std::array<SideBySide, 3>& d, const SideBySide& weight) {
    const auto& [x, y, z] = d;
    sums.add(weight, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z);
  }

  void write(const Eigen::Vector3f& normal, Writer& to) const {
    const auto [x, y, z, xx, yy, zz, xy, xz, yz] = sums.means();
    const Eigen::Vector3f m(x, y, z), u(xx, xy, xz), v(xy, yy, yz), w(xz, yz, zz);  // rows of the second
    const float across = normal.dot(Eigen::Vector3f(u.dot(normal), v.dot(normal), w.dot(normal))),
                off = m.dot(normal);
    // The two eigenvalues along the surface: their sum is the rest of the trace, and their product is what
    // the adjugate is along n.
    const float half = std::max(0.0F, 0.5F * (xx + yy + zz - across));
    const float product =
        normal.dot(normal[0] * v.cross(w) + normal[1] * w.cross(u) + normal[2] * u.cross(v));
    const float apart = std::sqrt(std::max(0.0F, half * half - product));
    to.odd(off);
    to.even(std::sqrt(std::max(0.0F, across)) / 3);
    to.even(std::sqrt(half + apart) / 3);
    to.even(std::sqrt(std::max(0.0F, half - apart)) / 3);
    to.even(std::sqrt(std::max(0.0F, m.squaredNorm() - off * off)));
  }
};

/// Means of the residuals' powers.
struct Residuals {
  Sums<4> sums;

  void add(const SideBySide& r, const SideBySide& weight) {
    const SideBySide square = r.square();
    sums.add(weight, r, square, square * r, square.square());
  }

  void write(Writer& to) const {
    const auto [first, second, third, fourth] = sums.means();
    to.odd(first);
    to.odd(third / 6);
    to.even(second);
    to.even(fourth / 6);
  }
};

}  // namespace

Features::Features(const HeightField& field, const Positions& data, const Smoothed& smoothed,
                   const rfs_mesh::NoiseField& noise, double spacing, const Context& context)
    : field_(field), smoothed_(smoothed), noise_(noise), spacing_(spacing) {
  constexpr int kTimes = 4;
  packed_.resize(field.size());
  pooled_.resize(field.size());
  for_each_index(context, field.size(), [&](std::size_t i) {
    const Eigen::Vector3d& guide = field.guide()[i];
    const float r = std::clamp((field.local()[i].height - height(i)) / scale(i), -kFarResidual, kFarResidual);
    packed_[i] = {(data[i] - guide).cast<float>(), (smoothed.place[i] - guide).cast<float>(),
                  field.local()[i].normal, r};
    const float narrow = candidate(i, smoothed.scales[i][0].height),
                third = candidate(i, smoothed.scales[i][2].height);
    pooled_[i] << r, r * r, r * r * r / 6, r * r * r * r / 6, smoothed.own[i], narrow * narrow, third * third,
        0;
  });
  for (int t = 0; t < kTimes; ++t) pooled_ = field.local_mean(pooled_, context);
}

float Features::candidate(std::size_t i, float that) const {
  if (std::isnan(that)) return 0;
  return std::clamp((that - height(i)) / scale(i), -kFarCandidate, kFarCandidate);
}

void Features::fill(std::size_t i, Row& row, std::vector<rfs_mesh::Neighbor>& near) const {
  Writer to(row);
  const float s = scale(i);
  for (const ScaleSays& says : smoothed_.scales[i]) {
    to.odd(candidate(i, says.height));
    to.even(says.own);
    to.even(std::clamp(says.near, -kFarEvidence, kFarEvidence));
    to.even(std::clamp(says.wide, -kFarEvidence, kFarEvidence));
  }
  to.odd(packed_[i].residual);
  to.odd(candidate(i, smoothed_.mixed[i]));
  to.even(smoothed_.own[i]);
  to.odd(pooled_[i][0]);
  to.odd(pooled_[i][2]);
  for (const Eigen::Index k : {1, 3, 4, 5, 6}) to.even(pooled_[i][k]);

  const Eigen::Vector3d& centre = field_.guide()[i];
  const Eigen::Vector3f normal = packed_[i].normal, at = packed_[i].place;
  const float unit = 1 / s;
  Histogram inner, outer;
  Sheets sheets;
  Moments moments;
  Residuals close, wide;
  field_.index().within_unsorted(centre, kSeen * double(s), near);
  for (std::size_t first = 0; first < near.size(); first += kSideBySide) {
    const std::size_t count = std::min(near.size() - first, kSideBySide);
    SideBySide there = SideBySide::Zero(), residual = SideBySide::Zero();
    std::array<SideBySide, 3> d, p, facing;  // data and P, in s from this point's P; normals
    d.fill(SideBySide::Zero());
    p = facing = d;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t j = near[first + k].index;
      const Packed& one = packed_[j];
      const Eigen::Vector3f from = (field_.guide()[j] - centre).cast<float>() - at,
                            data = unit * (from + one.data), place = unit * (from + one.place);
      const auto lane = Eigen::Index(k);
      there[lane] = 1;
      residual[lane] = one.residual;
      for (std::size_t c = 0; c < 3; ++c) {
        d[c][lane] = data[Eigen::Index(c)];
        p[c][lane] = place[Eigen::Index(c)];
        facing[c][lane] = one.normal[Eigen::Index(c)];
      }
    }
    const auto along = [&](const std::array<SideBySide, 3>& v) -> SideBySide {
      return v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2];
    };
    const auto squared = [](const std::array<SideBySide, 3>& v) -> SideBySide {
      return v[0].square() + v[1].square() + v[2].square();
    };
    const SideBySide height = along(d), square = squared(d), beside = square - height.square(),
                     away = squared(p), cosine = along(facing), same = there * same_sheet(cosine);
    inner.add(height, there * biweight(beside / (kInner * kInner)));
    outer.add(height, there * biweight(beside / (kOuter * kOuter)));
    sheets.add(along(p), cosine, there * biweight(away / (kAround * kAround)));
    close.add(residual, same * biweight(away / (kInner * kInner)));
    wide.add(residual, same * biweight(away / (kOuter * kOuter)));
    moments.add(d, there * biweight(square / (kMoments * kMoments)));
  }
  // A flat sheet has about one point in a square spacing; the weights over a disc of radius r sum to a third
  // of its area.
  const float dense = float(s / spacing_), flat = dense * dense;
  close.write(to);
  wide.write(to);
  inner.write(kInner * kInner * flat, to);
  outer.write(kOuter * kOuter * flat, to);
  sheets.write(to);
  moments.write(normal, to);
  to.even(squashed(dense));
  to.even(s / float(noise_.local[i]));
  to.even(float(smoothed_.variance));
}

}  // namespace rfsmooth::smoothing
