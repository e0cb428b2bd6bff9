#include "smoothing/automatic/patches/patches.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>

#include "base/collect.h"
#include "base/linear/small_cholesky.h"
#include "base/parallel.h"
#include "rfs_mesh/fit/scatter.h"
#include "rfs_mesh/search/thinning.h"
#include "smoothing/automatic/patches/quadric_sums.h"
#include "smoothing/automatic/patches/weighted_sum.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kAxis = 12;                      // nearest points whose normals make the patch's axis
constexpr float kWeightUnit = 65535, kRounded = 0.5F;  // of the weights kept
constexpr double kOnePlace = 1e-6;  // sigma: members of so small a patch are one place; it is flat
constexpr float kCovered = 0.2F * kWeightUnit;  // least weight of the best patch over a point
constexpr std::size_t kPowers[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};  // of u and v
constexpr double kRough = 0.1;  // variance beyond the noise's, sigma^2: there is more than one sheet
constexpr std::size_t kMostForMissing = 8;  // times the patches given: 4 cost rotor 3 % of p2s
constexpr std::size_t kTogether = 64;       // patches fitted in a row: each tells the next how far to look
constexpr std::size_t kWave = 1 << 20;      // members fitted before they are put behind those before, ...
constexpr std::size_t kLeastWave = 8 * kTogether;  // ... of at least so many patches
constexpr std::size_t kRange = 16384;              // points whose lists are made together
constexpr std::size_t kGroup = 4096;               // members looked through together for them

typedef float Floats __attribute__((vector_size(4 * sizeof(float))));

Floats four(const float* at) {
  Floats f;
  std::memcpy(&f, at, sizeof f);
  return f;
}

float total(const Floats& f) {
  return (f[0] + f[1]) + (f[2] + f[3]);
}

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

/// The members of one patch, by axis, in its frame.
struct Patches::Workspace {
  Workspace(const HeightField& field, std::size_t members) : near(field.index(), members) {
    for (std::vector<float>* values : {&u, &v, &height, &weight, &cosine}) values->assign(padded(members), 0);
  }
  rfs_mesh::WideNeighbors near;
  std::vector<float> u, v, height, weight, cosine;
};

/// How many patches are over each point, and where their members are. Points are taken in ranges and members
/// in groups; both lie in memory about as in space, so a group has members in few ranges.
struct Patches::Covering {
  explicit Covering(std::size_t n) : groups((n + kRange - 1) / kRange), patches(n, 0), covered(n, 0) {}
  /// The patches [begin, end).
  struct Group {
    std::size_t begin, end;
  };
  std::vector<std::vector<Group>> groups;  ///< of each range, ascending
  std::vector<Index> patches;              ///< n
  std::vector<char> covered;               ///< n
};

Patches::Patches(const HeightField& field, std::size_t members, std::vector<Index> seeds,
                 const std::vector<double>& sigma, Memory& memory, const Context& context)
    : field_(field), members_(std::min(members, field.size())), seeds_(std::move(seeds)), memory_(memory) {
  memory_.patches_ = {};  // wide patches are few
  memory_.start_.assign(1, 0);
  memory_.member_.clear();
  memory_.member_weight_.clear();
  memory_.over_.clear();
  memory_.over_weight_.clear();
  Covering covering(field_.size());
  fit(0, seeds_.size(), sigma, context);
  count(0, seeds_.size(), covering, context);
  cover_missing(sigma, covering, context);
  transpose(covering, context);
}

/// A place between sheets or at the end of something thin may be in no patch, or only at the rim of one: such
/// places get patches of their own. Where there are many, some of these patches reach most of the others.
void Patches::cover_missing(const std::vector<double>& sigma, Covering& covering, const Context& context) {
  const std::size_t most = kMostForMissing * seeds_.size();
  std::size_t before = field_.size() + 1;  // so many were missing
  for (bool last = false; !last;) {
    const auto missing = rfsmooth::collect<Index>(context, field_.size(), [&](std::size_t i, auto&& emit) {
      if (covering.covered[i] == 0) emit(Index(i));
    });
    std::vector<Index> more = rfs_mesh::thin(field_.guide(), missing, context);
    last = more.size() <= most || missing.size() >= before;
    before = missing.size();
    while (!last && more.size() > most) more = rfs_mesh::thin(field_.guide(), more, context);
    const std::size_t first = seeds_.size();
    seeds_.insert(seeds_.end(), more.begin(), more.end());
    fit(first, seeds_.size(), sigma, context);
    count(first, seeds_.size(), covering, context);
  }
}

void Patches::fit(std::size_t first, std::size_t last, const std::vector<double>& sigma,
                  const Context& context) {
  if (last * members_ > kNone) throw std::length_error("Patches: too many members");
  memory_.patches_.resize(last);
  memory_.start_.resize(last + 1);
  // Room for all; what the members of other sheets leave at the end is never touched, and takes no memory.
  const std::size_t most = memory_.start_[first] + (last - first) * members_;
  memory_.member_.resize(most);
  memory_.member_weight_.resize(most);
  const std::size_t wave = std::max(kWave / members_ / kTogether * kTogether, kLeastWave);
  RawArray<Index> member(std::min(wave, last - first) * members_);
  RawArray<Weight> weight(member.size());
  for (std::size_t from = first; from < last; from += wave) {
    const std::size_t count = std::min(wave, last - from);
    std::vector<std::size_t> kept(count);
    for_blocks(context, count, kTogether, [&](std::size_t begin, std::size_t end) {
      Workspace work(field_, members_);
      for (std::size_t k = begin; k < end; ++k)
        kept[k] = fit_one(from + k, sigma[seeds_[from + k]], work, member.data() + k * members_,
                          weight.data() + k * members_);
    });
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t to = memory_.start_[from + k];
      std::copy_n(member.data() + k * members_, kept[k], memory_.member_.data() + to);
      std::copy_n(weight.data() + k * members_, kept[k], memory_.member_weight_.data() + to);
      memory_.start_[from + k + 1] = Index(to + kept[k]);
    }
  }
  memory_.member_.resize(memory_.start_[last]);
  memory_.member_weight_.resize(memory_.start_[last]);
}

Eigen::Vector3d Patches::axis_at(Index seed) const {
  const std::vector<HeightField::Local>& local = field_.local();
  const Eigen::Vector3f own = local[seed].normal;
  Eigen::Vector3f sum_of_normals = 2 * own;
  const auto row = field_.neighbors()[seed];
  for (std::size_t k = 0; k < std::min(row.size(), kAxis - 1); ++k)
    if (const Eigen::Vector3f& n = local[row[k]].normal; same_sheet(n.dot(own)) > 0) sum_of_normals += n;
  return sum_of_normals.cast<double>().normalized();
}

Patches::Members Patches::gather(std::size_t s, double sigma, Workspace& work, Index* member,
                                 Weight* weight) {
  Patch& patch = memory_.patches_[s];
  rfs_mesh::WideNeighbors& near = work.near;
  near.find(patch.centre);
  const Eigen::Vector3d axis = axis_at(seeds_[s]);
  // A little beyond the farthest point, so that it counts.
  const float square = std::max(1.1F * near.farthest(), std::numeric_limits<float>::min());
  const PatchAxes flat = field_.on_lines() ? along_line(near, axis, square) : patch_axes(axis);
  float shrink = 1 / std::sqrt(square);  // from the lengths of `near` to radii
  Members all;
  all.radius = near.unit() / double(shrink);
  if (all.radius < kOnePlace * sigma) {
    all.radius = kOnePlace * sigma;
    shrink = float(near.unit() / all.radius);
  }
  patch.radius = float(all.radius);
  const Eigen::Vector3f along = axis.cast<float>(), u = flat.u.cast<float>() * shrink,
                        v = flat.v.cast<float>() * shrink, up = along * shrink;
  const Eigen::Vector3f u_in_radii = (flat.u / all.radius).cast<float>(),
                        v_in_radii = (flat.v / all.radius).cast<float>();
  for (std::size_t of = 0; of < 3; ++of) {
    const auto x = Eigen::Index(of);
    float* const parts = patch.frame.data() + 4 * of;
    parts[0] = u_in_radii[x];
    parts[1] = v_in_radii[x];
    parts[2] = along[x];
    parts[3] = 0;
  }

  const auto in_radii = float(1 / all.radius);
  for (std::size_t k = 0; k < members_; ++k) {
    const Index i = near.index()[k];
    const HeightField::Local& here = field_.local()[i];
    const float cosine = along.dot(here.normal);
    const float inside = 1 - near.squared()[k] / square;
    const float w = same_sheet(cosine) * inside * inside;
    const Eigen::Vector3f r(near.x()[k], near.y()[k], near.z()[k]);
    work.u[k] = u.dot(r);
    work.v[k] = v.dot(r);
    work.height[k] = w > 0 ? up.dot(r) + here.height * in_radii / cosine : 0;
    work.weight[k] = w;
    work.cosine[k] = cosine;
    member[all.kept] = i;
    weight[all.kept] = Weight(w * kWeightUnit + kRounded);
    all.kept += std::size_t(weight[all.kept] != 0);
    all.sum += double(w);
    all.squares += double(w) * double(w);
  }
  return all;
}

std::size_t Patches::fit_one(std::size_t s, double sigma, Workspace& work, Index* member, Weight* weight) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  Patch& patch = memory_.patches_[s];
  patch.centre = field_.guide()[seeds_[s]];
  patch.weight = 0;
  patch.several = false;
  patch.quadric.fill(0);
  patch.spread.fill(0);
  patch.spread_u4 = 0;
  const Members all = gather(s, sigma, work, member, weight);
  if (!(all.sum > 0)) return 0;
  const std::size_t size = padded(members_);
  QuadricSums sums;
  sum_quadric(size, work.u.data(), work.v.data(), work.height.data(), work.weight.data(), sums);
  // Few points, or points in a line, leave the quadric undetermined: the ridge makes it flat there.
  Matrix6 system = sums.a;
  system.diagonal().array() += 1e-9 * system(0, 0) + 1e-12;
  const Matrix6 inverse = SmallCholesky<6>(system).inverse();
  const Vector6 quadric = inverse * sums.right;
  for (int a = 0; a < 6; ++a) {
    patch.quadric[4 * kPowers[a][1] + kPowers[a][0]] = float(quadric[a]);
    for (int b = 0; b < 6; ++b) {
      const std::size_t u_power = kPowers[a][0] + kPowers[b][0], v_power = kPowers[a][1] + kPowers[b][1];
      (u_power == 4 ? patch.spread_u4 : patch.spread[4 * v_power + u_power]) += float(inverse(a, b));
    }
  }

  const double in_sigma = all.radius / sigma;
  const double residuals = in_sigma * in_sigma *
                           sum_residuals(size, work.u.data(), work.v.data(), work.height.data(),
                                         work.weight.data(), work.cosine.data(), quadric);
  Matrix6 squared;
  sum_squared_weights(size, work.u.data(), work.v.data(), work.weight.data(), squared);
  const double leverage = inverse.cwiseProduct(squared).sum();
  const double points = all.sum * all.sum / all.squares, variance = 6 / points;
  const double excess = (residuals - (all.sum - leverage)) / all.sum - std::sqrt(2 / points);
  patch.several = excess > kRough;
  patch.weight = float(variance / (variance + std::max(0.0, excess)));
  return all.kept;
}

/// Counts the patches [first, last) over the points.
void Patches::count(std::size_t first, std::size_t last, Covering& covering, const Context& context) {
  const std::size_t in_group = std::max<std::size_t>(1, kGroup / members_);
  const auto patches_of = [&](std::size_t g) {
    return Covering::Group{first + g * in_group, std::min(last, first + (g + 1) * in_group)};
  };
  std::vector<std::vector<Index>> ranges((last - first + in_group - 1) / in_group);  // that a group touches
  for_each_index(
      context, ranges.size(),
      [&](std::size_t g) {
        const Covering::Group group = patches_of(g);
        Index before = kNone;
        for (std::size_t k = memory_.start_[group.begin]; k < memory_.start_[group.end]; ++k) {
          const auto range = Index(memory_.member_[k] / kRange);
          if (range == before) continue;
          before = range;
          if (std::find(ranges[g].begin(), ranges[g].end(), range) == ranges[g].end())
            ranges[g].push_back(range);
        }
      },
      16);
  for (std::size_t g = 0; g < ranges.size(); ++g)
    for (const Index range : ranges[g]) covering.groups[range].push_back(patches_of(g));
  for_each_index(
      context, covering.groups.size(),
      [&](std::size_t range) {
        for (const Covering::Group& group : covering.groups[range]) {
          if (group.begin < first) continue;  // counted before
          for (std::size_t k = memory_.start_[group.begin]; k < memory_.start_[group.end]; ++k) {
            const Index i = memory_.member_[k];
            if (i / kRange != range) continue;
            ++covering.patches[i];
            if (memory_.member_weight_[k] >= kCovered) covering.covered[i] = 1;
          }
        }
      },
      1);
}

/// The lists of members the other way round.
void Patches::transpose(const Covering& covering, const Context& context) {
  const std::size_t n = field_.size();
  memory_.over_start_.resize(n + 1);
  memory_.over_start_[0] = 0;
  for (std::size_t i = 0; i < n; ++i)
    memory_.over_start_[i + 1] = memory_.over_start_[i] + covering.patches[i];
  memory_.over_.resize(memory_.over_start_[n]);
  memory_.over_weight_.resize(memory_.over_start_[n]);
  for_each_index(
      context, covering.groups.size(),
      [&](std::size_t range) {
        const std::size_t begin = range * kRange, end = std::min(n, begin + kRange);
        std::vector<Index> next(memory_.over_start_.begin() + std::ptrdiff_t(begin),
                                memory_.over_start_.begin() + std::ptrdiff_t(end));
        for (const Covering::Group& group : covering.groups[range])
          for (std::size_t s = group.begin; s < group.end; ++s)
            for (std::size_t k = memory_.start_[s]; k < memory_.start_[s + 1]; ++k) {
              const Index i = memory_.member_[k];
              if (i / kRange != range) continue;
              const Index to = next[i - begin]++;
              memory_.over_[to] = Index(s);
              memory_.over_weight_[to] = memory_.member_weight_[k];
            }
      },
      1);
}

Prediction Patches::predict(const Context& context) const {
  const std::size_t n = field_.size();
  Prediction p{std::vector<float>(n, 0), std::vector<float>(n, 0), std::vector<char>(n, 0)};
  for_each_index(context, n, [&](std::size_t i) {
    const Eigen::Vector3f& normal = field_.local()[i].normal;
    float height = 0, own = 0, weights = 0;
    for (Index k = memory_.over_start_[i]; k < memory_.over_start_[i + 1]; ++k) {
      const Patch& patch = memory_.patches_[memory_.over_[k]];
      const float e = float(memory_.over_weight_[k]) / kWeightUnit, w = e * patch.weight;
      const Eigen::Vector3f r = (field_.guide()[i] - patch.centre).cast<float>();
      const Floats x = four(patch.frame.data()), y = four(patch.frame.data() + 4),
                   z = four(patch.frame.data() + 8), parts = r.x() * x + r.y() * y + r.z() * z;
      const float cosine = normal.x() * x[2] + normal.y() * y[2] + normal.z() * z[2];
      const float u = parts[0], v = parts[1], uu = u * u;
      const Floats powers = {1, u, uu, uu * u};
      const float *const q = patch.quadric.data(), *const s = patch.spread.data();
      const float value = total(powers * (four(q) + v * (four(q + 4) + v * four(q + 8))));
      const Floats in_v =
          four(s) + v * (four(s + 4) + v * (four(s + 8) + v * (four(s + 12) + v * four(s + 16))));
      height += w * (value * patch.radius - parts[2]) * cosine;
      own += w * e * (total(powers * in_v) + patch.spread_u4 * uu * uu);
      weights += w;
    }
    if (!(weights > 0)) return;
    p.height[i] = height / weights;
    p.own[i] = own / weights;
    p.covered[i] = 1;
  });
  return p;
}

std::vector<Index> Patches::with_several_sheets() const {
  std::vector<Index> found;
  for (std::size_t s = 0; s < seeds_.size(); ++s)
    if (memory_.patches_[s].several) found.push_back(seeds_[s]);
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<float> Patches::mean(const std::vector<float>& values, const Context& context) const {
  std::vector<float> of_patch(memory_.patches_.size(), 0), mean = values;
  for_each_index(
      context, memory_.patches_.size(),
      [&](std::size_t s) {
        const std::size_t begin = memory_.start_[s];
        const WeightedSum inside = weighted_sum(memory_.start_[s + 1] - begin, memory_.member_.data() + begin,
                                                memory_.member_weight_.data() + begin, values.data());
        if (inside.weights > 0) of_patch[s] = inside.sum / inside.weights;
      },
      kTogether);
  for_each_index(context, field_.size(), [&](std::size_t i) {
    float sum = 0, weights = 0;
    for (Index k = memory_.over_start_[i]; k < memory_.over_start_[i + 1]; ++k) {
      const float w = memory_.over_weight_[k];
      sum += w * of_patch[memory_.over_[k]];
      weights += w;
    }
    if (weights > 0) mean[i] = sum / weights;
  });
  return mean;
}

}  // namespace rfsmooth::smoothing
