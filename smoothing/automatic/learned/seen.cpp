#include "smoothing/automatic/learned/seen.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/avx2.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kLanes = Surroundings::kLanes;

inline float biweight(float x) {
  const float rest = std::max(0.0F, 1 - x);
  return rest * rest;
}

/// Where a block of columns of one kind begins.
struct At {
  At(const std::array<Surroundings::Column, 3>& columns, std::size_t first)
      : x(columns[0].data() + first), y(columns[1].data() + first), z(columns[2].data() + first) {}
  const float *x, *y, *z;
};

using Lanes = float[kLanes];
using Whole = std::int32_t[kLanes];

/// All lanes, where a loop over them does not compile to vector instructions by itself.
typedef float AllLanes __attribute__((vector_size(sizeof(Lanes))));

/// A number of the inner and of the outer disc side by side. Added to a bin in one go, and never to a part of
/// what was written just before: a processor waits for that.
typedef float Both __attribute__((vector_size(2 * sizeof(float))));

/// Weights of the two discs into their bins. `counts` is 0 for heights that are in no bin, `low` the lower of
/// the two bins that share a height, `upper` the part of the upper one.
inline void add_heights(const Lanes& inner, const Lanes& outer, const Lanes& counts, const Whole& low,
                        const Lanes& upper, Both* bins) {
  AllLanes in, out, counted, share;
  std::memcpy(&in, inner, sizeof in);
  std::memcpy(&out, outer, sizeof out);
  std::memcpy(&counted, counts, sizeof counted);
  std::memcpy(&share, upper, sizeof share);
  in *= counted;
  out *= counted;
  const AllLanes in_second = in * share, out_second = out * share, in_first = in - in_second,
                 out_first = out - out_second;
  for (std::size_t l = 0; l < kLanes; ++l) {
    bins[low[l]] += Both{in_first[l], out_first[l]};
    bins[low[l] + 1] += Both{in_second[l], out_second[l]};
  }
}

inline void add_weights(const Lanes& weight, Histogram& to) {
  for (std::size_t l = 0; l < kLanes; ++l) to.all[l] += weight[l];
}

inline void add_sheets(const Lanes& weight, const Lanes& height, const Lanes& facing, Sums<7>& s) {
  for (std::size_t l = 0; l < kLanes; ++l) {
    const float w = weight[l], at = height[l], cosine = facing[l], along = w * std::max(cosine, 0.0F),
                away = w * std::max(-cosine, 0.0F);
    s.all[l] += w;
    s.sum[0][l] += w * at;
    s.sum[1][l] += w * at * at;
    s.sum[2][l] += along;
    s.sum[3][l] += away;
    s.sum[4][l] += w * cosine * cosine;
    s.sum[5][l] += along * at;
    s.sum[6][l] += away * at;
  }
}

inline void add_moments(const Lanes& weight, const Lanes& dx, const Lanes& dy, const Lanes& dz, Sums<9>& s) {
  for (std::size_t l = 0; l < kLanes; ++l) {
    const float w = weight[l], x = dx[l], y = dy[l], z = dz[l];
    s.all[l] += w;
    s.sum[0][l] += w * x;
    s.sum[1][l] += w * y;
    s.sum[2][l] += w * z;
    s.sum[3][l] += w * x * x;
    s.sum[4][l] += w * y * y;
    s.sum[5][l] += w * z * z;
    s.sum[6][l] += w * x * y;
    s.sum[7][l] += w * x * z;
    s.sum[8][l] += w * y * z;
  }
}

inline void add(const AllLanes& values, Lanes& to) {
  AllLanes sum;
  std::memcpy(&sum, to, sizeof sum);
  sum += values;
  std::memcpy(to, &sum, sizeof sum);
}

inline void add_residuals(const Lanes& weight, const float* residual, Sums<4>& s) {
  AllLanes w, r;
  std::memcpy(&w, weight, sizeof w);
  std::memcpy(&r, residual, sizeof r);
  const AllLanes square = r * r;
  add(w, s.all);
  add(w * r, s.sum[0]);
  add(w * square, s.sum[1]);
  add(w * square * r, s.sum[2]);
  add(w * square * square, s.sum[3]);
}

}  // namespace

RFSMOOTH_AVX2
void see(const Surroundings& around, const Here& here, Seen& seen) {
  const float ox = here.shift[0], oy = here.shift[1], oz = here.shift[2], fx = here.from[0],
              fy = here.from[1], fz = here.from[2], nx = here.normal[0], ny = here.normal[1],
              nz = here.normal[2];
  const float per_unit = here.per_unit, most = here.radius * here.radius;
  Both bins[2 * kSide + 2] = {};  // one more: a height just below the last may be rounded up to it
  for (std::size_t first = 0; first < around.size(); first += kLanes) {
    const At g(around.guide, first), d(around.data, first), p(around.place, first), m(around.normal, first);
    Lanes gx, gy, gz, in_ball;
    std::int32_t any = 0;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const float x = g.x[l] + ox, y = g.y[l] + oy, z = g.z[l] + oz;
      gx[l] = x;
      gy[l] = y;
      gz[l] = z;
      const bool there = x * x + y * y + z * z <= most;
      in_ball[l] = there ? 1.0F : 0.0F;
      any |= std::int32_t(there);
    }
    if (any == 0) continue;  // often: points come leaf by leaf of the tree
    Lanes dx, dy, dz, along, facing, inner, outer, sheets, moments, close, wide, counts, upper;
    Whole low;
    for (std::size_t l = 0; l < kLanes; ++l) {
      const float x = gx[l], y = gy[l], z = gz[l], there = in_ball[l];
      const float ax = x - fx, ay = y - fy, az = z - fz;
      const float ux = per_unit * (ax + d.x[l]), uy = per_unit * (ay + d.y[l]), uz = per_unit * (az + d.z[l]);
      const float vx = per_unit * (ax + p.x[l]), vy = per_unit * (ay + p.y[l]), vz = per_unit * (az + p.z[l]);
      const float up = ux * nx + uy * ny + uz * nz, square = ux * ux + uy * uy + uz * uz,
                  beside = square - up * up, away = vx * vx + vy * vy + vz * vz,
                  cosine = m.x[l] * nx + m.y[l] * ny + m.z[l] * nz,
                  same = (cosine < float(rfs_mesh::kSameSheet) ? 0.0F : there) * cosine * cosine;
      dx[l] = ux;
      dy[l] = uy;
      dz[l] = uz;
      along[l] = vx * nx + vy * ny + vz * nz;
      facing[l] = cosine;
      const float heights = up * (1 / kBin), counted = std::abs(heights) < float(kSide) ? 1.0F : 0.0F;
      counts[l] = counted;
      const float at = counted * (heights + float(kSide));
      low[l] = std::int32_t(at);
      upper[l] = at - float(low[l]);
      // A quarter is exact: fewer divisions, the same bits.
      static_assert(kOuter == 2 * kInner);
      const float beside_inner = beside / (kInner * kInner), away_inner = away / (kInner * kInner);
      inner[l] = there * biweight(beside_inner);
      outer[l] = there * biweight(0.25F * beside_inner);
      sheets[l] = there * biweight(away / (kAround * kAround));
      moments[l] = there * biweight(square / (kMoments * kMoments));
      close[l] = same * biweight(away_inner);
      wide[l] = same * biweight(0.25F * away_inner);
    }
    add_sheets(sheets, along, facing, seen.sheets);
    add_moments(moments, dx, dy, dz, seen.moments);
    add_residuals(close, around.residual.data() + first, seen.close);
    add_residuals(wide, around.residual.data() + first, seen.wide);
    add_weights(inner, seen.inner);
    add_weights(outer, seen.outer);
    add_heights(inner, outer, counts, low, upper, bins);
  }
  for (std::size_t k = 0; k < seen.inner.bin.size(); ++k) {
    seen.inner.bin[k] += bins[k][0];
    seen.outer.bin[k] += bins[k][1];
  }
}

}  // namespace rfsmooth::smoothing
