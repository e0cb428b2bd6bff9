#include "rfsmooth/smoothing/patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/smoothing/quadric_sums.h"
#include "rfsmooth/smoothing/thinning.h"
#include "rfsmooth/smoothing/weighted_sum.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kAxis = 12;                      // nearest points whose normals make the patch's axis
constexpr float kCovered = 0.2F;                       // least weight of the best patch over a point
constexpr float kWeightUnit = 65535, kRounded = 0.5F;  // of the weights kept
constexpr std::size_t kPowers[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};  // of u and v
constexpr std::size_t kTogether = 64;  // patches fitted in a row: each tells the next how far to look

}  // namespace

/// The members of one patch, by axis, in its frame.
struct Patches::Workspace {
  Workspace(const HeightField& field, std::size_t members) : near(field.index(), members) {
    for (std::vector<float>* values : {&u, &v, &height, &weight, &cosine}) values->assign(padded(members), 0);
  }
  rfs_mesh::WideNeighbors near;
  std::vector<float> u, v, height, weight, cosine;
};

/// Filled by all fits at once: counting and marking do not depend on the order.
struct Patches::Covering {
  explicit Covering(std::size_t n) : patches(n), covered(n) {}
  std::vector<std::atomic<Index>>
      patches;                             ///< n: how many are over the point; later, where its next one goes
  std::vector<std::atomic<char>> covered;  ///< n
};

Patches::Patches(const HeightField& field, std::size_t members, std::vector<Index> seeds,
                 const std::vector<double>& sigma, const Context& context)
    : field_(field),
      members_(std::min(members, field.size())),
      per_member_(1 / double(members_)),
      seeds_(std::move(seeds)) {
  Covering covering(field_.size());
  fit(0, seeds_.size(), sigma, covering, context);
  // A place between sheets or at the end of something thin may be in no patch, or only at the rim of one.
  std::vector<Index> missing;
  for (std::size_t i = 0; i < field_.size(); ++i)
    if (covering.covered[i] == 0) missing.push_back(Index(i));
  if (!missing.empty()) {
    const std::size_t first = seeds_.size();
    const std::vector<Index> more = thin(field.guide(), missing, context);
    seeds_.insert(seeds_.end(), more.begin(), more.end());
    fit(first, seeds_.size(), sigma, covering, context);
  }
  transpose(covering, context);
}

void Patches::fit(std::size_t first, std::size_t last, const std::vector<double>& sigma, Covering& covering,
                  const Context& context) {
  if (last * members_ > kNone) throw std::length_error("Patches: too many members");
  patches_.resize(last);
  member_.resize(last * members_);
  member_weight_.resize(last * members_);
  for_blocks(context, last - first, kTogether, [&](std::size_t begin, std::size_t end) {
    Workspace work(field_, members_);
    for (std::size_t s = first + begin; s < first + end; ++s) {
      fit_one(s, sigma[seeds_[s]], work);
      for (std::size_t k = 0; k < members_; ++k) {
        const Index i = member_[s * members_ + k];
        if (member_weight_[s * members_ + k] == 0) continue;
        covering.patches[i].fetch_add(1, std::memory_order_relaxed);
        if (work.weight[k] >= kCovered) covering.covered[i].store(1, std::memory_order_relaxed);
      }
    }
  });
}

void Patches::fit_one(std::size_t s, double sigma, Workspace& work) {
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  const Index seed = seeds_[s];
  Patch& patch = patches_[s];
  patch.centre = field_.guide()[seed];
  rfs_mesh::WideNeighbors& near = work.near;
  near.find(patch.centre);

  const std::vector<HeightField::Local>& local = field_.local();
  const Eigen::Vector3f own = local[seed].normal;
  Eigen::Vector3f sum_of_normals = 2 * own;
  const auto row = field_.neighbors()[seed];
  for (std::size_t k = 0; k < std::min(row.size(), kAxis - 1); ++k)
    if (const Eigen::Vector3f& n = local[row[k]].normal; same_sheet(n.dot(own)) > 0) sum_of_normals += n;
  const Eigen::Vector3d axis = sum_of_normals.cast<double>().normalized();
  // A little beyond the farthest point, so that it counts.
  const float square = std::max(1.1F * near.farthest(), std::numeric_limits<float>::min());
  const float shrink = 1 / std::sqrt(square);  // from the lengths of `near` to radii
  const double radius = near.unit() / double(shrink);
  const Eigen::Vector3d across = axis.unitOrthogonal();
  patch.radius = float(radius);
  patch.axis = axis.cast<float>();
  const Eigen::Vector3f u = across.cast<float>() * shrink, v = axis.cross(across).cast<float>() * shrink,
                        up = patch.axis * shrink;
  patch.u = (across / radius).cast<float>();
  patch.v = (axis.cross(across) / radius).cast<float>();

  const auto in_radii = float(1 / radius);
  Weight* const weights = member_weight_.data() + s * members_;
  Index* const indices = member_.data() + s * members_;
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < members_; ++k) {
    const Index i = near.index()[k];
    const HeightField::Local& here = local[i];
    const float cosine = patch.axis.dot(here.normal);
    const float inside = 1 - near.squared()[k] / square;
    const float w = same_sheet(cosine) * inside * inside;
    const Eigen::Vector3f r(near.x()[k], near.y()[k], near.z()[k]);
    work.u[k] = u.dot(r);
    work.v[k] = v.dot(r);
    work.height[k] = w > 0 ? up.dot(r) + here.height * in_radii / cosine : 0;
    work.weight[k] = w;
    work.cosine[k] = cosine;
    indices[k] = i;
    weights[k] = Weight(w * kWeightUnit + kRounded);
    sum += double(w);
    squares += double(w) * double(w);
  }
  if (!(sum > 0)) {
    patch.weight = 0;
    return;
  }
  const std::size_t size = padded(members_);
  const QuadricSums sums =
      sum_quadric(size, work.u.data(), work.v.data(), work.height.data(), work.weight.data());
  // Few points, or points in a line, leave the quadric undetermined: the ridge makes it flat there.
  Matrix6 system = sums.a;
  system.diagonal().array() += 1e-9 * system(0, 0) + 1e-12;
  const Matrix6 inverse = system.llt().solve(Matrix6::Identity());
  const Vector6 quadric = inverse * sums.right;
  for (int a = 0; a < 6; ++a) {
    patch.quadric[std::size_t(a)] = float(quadric[a]);
    for (int b = 0; b < 6; ++b) {
      const std::size_t v_power = kPowers[a][1] + kPowers[b][1],
                        degree = kPowers[a][0] + kPowers[b][0] + v_power;
      patch.spread[degree * (degree + 1) / 2 + v_power] += float(inverse(a, b));
    }
  }

  const double in_sigma = radius / sigma;
  const double residuals = in_sigma * in_sigma *
                           sum_residuals(size, work.u.data(), work.v.data(), work.height.data(),
                                         work.weight.data(), work.cosine.data(), quadric);
  const double leverage =
      (inverse.array() * sum_squared_weights(size, work.u.data(), work.v.data(), work.weight.data()).array())
          .sum();
  const double points = sum * sum / squares, variance = 6 / points;
  const double excess = (residuals - (sum - leverage)) / sum - std::sqrt(2 / points);
  patch.weight = float(variance / (variance + std::max(0.0, excess)));
}

/// Which patches are over each point: the lists of members the other way round.
void Patches::transpose(Covering& covering, const Context& context) {
  const std::size_t n = field_.size();
  over_start_.resize(n + 1);
  over_start_[0] = 0;
  for (std::size_t i = 0; i < n; ++i) {
    over_start_[i + 1] = over_start_[i] + covering.patches[i];
    covering.patches[i] = over_start_[i];
  }
  over_.resize(over_start_[n]);
  for_each_index(
      context, patches_.size(),
      [&](std::size_t s) {
        for (std::size_t k = s * members_; k < (s + 1) * members_; ++k)
          if (member_weight_[k] != 0)
            over_[covering.patches[member_[k]].fetch_add(1, std::memory_order_relaxed)] = Index(k);
      },
      kTogether);
  // Threads put them in any order.
  for_each_index(context, n, [&](std::size_t i) {
    std::sort(over_.begin() + std::ptrdiff_t(over_start_[i]),
              over_.begin() + std::ptrdiff_t(over_start_[i + 1]));
  });
}

Prediction Patches::predict(const Context& context) const {
  const std::size_t n = field_.size();
  Prediction p{std::vector<float>(n, 0), std::vector<float>(n, 0), std::vector<char>(n, 0)};
  for_each_index(context, n, [&](std::size_t i) {
    const Eigen::Vector3f& normal = field_.local()[i].normal;
    float height = 0, own = 0, weights = 0;
    for (Index k = over_start_[i]; k < over_start_[i + 1]; ++k) {
      const Patch& patch = patches_[patch_of(over_[k])];
      const float e = float(member_weight_[over_[k]]) / kWeightUnit, w = e * patch.weight;
      const Eigen::Vector3f r = (field_.guide()[i] - patch.centre).cast<float>();
      const float a = r.dot(patch.u), b = r.dot(patch.v);
      const std::array<float, 6>& q = patch.quadric;
      const std::array<float, 15>& s = patch.spread;
      const float value = q[0] + a * (q[1] + a * q[3] + b * q[4]) + b * (q[2] + b * q[5]);
      const float aa = a * a, bb = b * b, ab = a * b;
      const float spread = s[0] + (a * s[1] + b * s[2]) + (aa * s[3] + ab * s[4] + bb * s[5]) +
                           (aa * (a * s[6] + b * s[7]) + bb * (a * s[8] + b * s[9])) +
                           (aa * (aa * s[10] + ab * s[11] + bb * s[12]) + bb * (ab * s[13] + bb * s[14]));
      height += w * (value * patch.radius - r.dot(patch.axis)) * patch.axis.dot(normal);
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

std::vector<float> Patches::mean(const std::vector<float>& values, const Context& context) const {
  std::vector<float> of_patch(patches_.size(), 0), mean = values;
  for_each_index(
      context, patches_.size(),
      [&](std::size_t s) {
        const WeightedSum inside = weighted_sum(members_, member_.data() + s * members_,
                                                member_weight_.data() + s * members_, values.data());
        if (inside.weights > 0) of_patch[s] = inside.sum / inside.weights;
      },
      kTogether);
  for_each_index(context, field_.size(), [&](std::size_t i) {
    float sum = 0, weights = 0;
    for (Index k = over_start_[i]; k < over_start_[i + 1]; ++k) {
      const float w = member_weight_[over_[k]];
      sum += w * of_patch[patch_of(over_[k])];
      weights += w;
    }
    if (weights > 0) mean[i] = sum / weights;
  });
  return mean;
}

}  // namespace rfsmooth::smoothing
