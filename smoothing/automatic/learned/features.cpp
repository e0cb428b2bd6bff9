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

/// (1 - x)^2 below 1.
float biweight(float x) {
  return x < 1 ? (1 - x) * (1 - x) : 0;
}

/// Heights of points in bins, each shared by the two nearest.
struct Histogram {
  std::array<float, 2 * kSide + 1> bin{};
  float all = 0;

  void add(float height, float weight) {
    const float at = height * (1 / kBin) + float(kSide);
    all += weight;
    if (!(at >= 0 && at < float(2 * kSide))) return;
    const auto k = std::size_t(at);
    const float part = at - float(k);
    bin[k] += weight * (1 - part);
    bin[k + 1] += weight * part;
  }

  /// `flat`: the weight of one flat sheet.
  void write(float flat, Writer& to) const {
    const float unit = 1 / (all + 1e-6F);
    to.even(unit * bin[kSide]);
    for (std::size_t k = 1; k <= kSide; ++k) {
      to.even(unit * (bin[kSide + k] + bin[kSide - k]));
      to.odd(unit * (bin[kSide + k] - bin[kSide - k]));
    }
    to.even(all / (all + flat));
  }
};

/// The smoothed points around one, and how they face.
struct Sheets {
  float all = 0, height = 0, square = 0, facing = 0, against = 0, either = 0, same = 0, other = 0;

  void add(float at, float cosine, float weight) {
    const float along = std::max(0.0F, cosine), away = std::max(0.0F, -cosine);
    all += weight;
    height += weight * at;
    square += weight * at * at;
    facing += weight * along;
    against += weight * away;
    either += weight * cosine * cosine;
    same += weight * along * at;
    other += weight * away * at;
  }

  void write(Writer& to) const {
    const float unit = 1 / (all + 1e-6F);
    to.odd(unit * height);
    to.odd(unit * same);
    to.odd(unit * other);
    to.even(0.25F * unit * square);
    to.even(unit * facing);
    to.even(unit * against);
    to.even(unit * either);
  }
};

/// Moments of the data up to the second.
struct Moments {
  float all = 0;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();

  void add(const Eigen::Vector3f& d, float weight) {
    all += weight;
    mean += weight * d;
    second += weight * d * d.transpose();
  }

  void write(const Eigen::Vector3f& normal, Writer& to) const {
    const float unit = 1 / (all + 1e-6F);
    const Eigen::Vector3f m = unit * mean;
    const Eigen::Matrix3f s = unit * second;
    const float across = normal.dot(s * normal), off = m.dot(normal);
    // The two eigenvalues along the surface: their sum is the rest of the trace, and their product is what
    // the adjugate of s is along n.
    const float half = 0.5F * (s.trace() - across);
    const Eigen::Vector3f u = s.row(0), v = s.row(1), w = s.row(2);
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
  float all = 0, first = 0, second = 0, third = 0, fourth = 0;

  void add(float r, float weight) {
    const float square = r * r;
    all += weight;
    first += weight * r;
    second += weight * square;
    third += weight * square * r;
    fourth += weight * square * square;
  }

  void write(Writer& to) const {
    const float unit = 1 / (all + 1e-6F);
    to.odd(unit * first);
    to.odd(unit * third / 6);
    to.even(unit * second);
    to.even(unit * fourth / 6);
  }
};

}  // namespace

Features::Features(const HeightField& field, const Positions& data, const Smoothed& smoothed,
                   const rfs_mesh::NoiseField& noise, double spacing, const Context& context)
    : field_(field), data_(data), smoothed_(smoothed), noise_(noise), spacing_(spacing) {
  constexpr int kTimes = 4;
  pooled_.resize(field.size());
  for_each_index(context, field.size(), [&](std::size_t i) {
    const float r = residual(i), narrow = candidate(i, smoothed.scales[i][0].height),
                third = candidate(i, smoothed.scales[i][2].height);
    pooled_[i] << r, r * r, r * r * r / 6, r * r * r * r / 6, smoothed.own[i], narrow * narrow, third * third,
        0;
  });
  for (int t = 0; t < kTimes; ++t) pooled_ = field.local_mean(pooled_, context);
}

float Features::residual(std::size_t i) const {
  return std::clamp((field_.local()[i].height - smoothed_.height[i]) / scale(i), -kFarResidual, kFarResidual);
}

float Features::candidate(std::size_t i, float height) const {
  if (std::isnan(height)) return 0;
  return std::clamp((height - smoothed_.height[i]) / scale(i), -kFarCandidate, kFarCandidate);
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
  to.odd(residual(i));
  to.even(smoothed_.own[i]);
  to.odd(pooled_[i][0]);
  to.odd(pooled_[i][2]);
  for (const Eigen::Index k : {1, 3, 4, 5, 6}) to.even(pooled_[i][k]);

  const Eigen::Vector3d at = place(i);
  const Eigen::Vector3f normal = field_.local()[i].normal;
  Histogram inner, outer;
  Sheets sheets;
  Moments moments;
  Residuals close, wide;
  field_.index().within(field_.guide()[i], kSeen * double(s), near);
  for (const rfs_mesh::Neighbor& n : near) {
    const std::size_t j = n.index;
    const Eigen::Vector3f d = ((data_[j] - at) / double(s)).cast<float>(),
                          p = ((place(j) - at) / double(s)).cast<float>();
    const float height = d.dot(normal), square = d.squaredNorm(), beside = square - height * height;
    inner.add(height, biweight(beside / (kInner * kInner)));
    outer.add(height, biweight(beside / (kOuter * kOuter)));
    const float cosine = field_.local()[j].normal.dot(normal), away = p.squaredNorm(), r = residual(j);
    sheets.add(p.dot(normal), cosine, biweight(away / (kAround * kAround)));
    close.add(r, same_sheet(cosine) * biweight(away / (kInner * kInner)));
    wide.add(r, same_sheet(cosine) * biweight(away / (kOuter * kOuter)));
    moments.add(d, biweight(square / (kMoments * kMoments)));
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
}

}  // namespace rfsmooth::smoothing
