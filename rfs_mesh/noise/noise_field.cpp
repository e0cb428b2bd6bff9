#include "rfs_mesh/noise/noise_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "rfs_mesh/noise/noise_levels.h"

namespace rfsmooth::rfs_mesh {

namespace {

// Chosen on the development shapes with noise of 0.1 to 4 spacings, Gaussian and along the ray
// (tests/bench/noise), but for the narrow pair: that is for clouds of which one half is louder
// (noise_accuracy_test.cpp).
constexpr double kAlike = 2.5;
// How far below and above the mean a fit pulls in proportion: logarithm of variance. Edges and second sheets
// are above, places within one step of the depths below.
constexpr float kBelow = 2, kAbove = 1.5;
constexpr double kFar = 400;   // of variances: a part twenty times as loud as another
constexpr float kCloud = 0.5;  // fits that the mean of the cloud counts as
constexpr int kFieldRounds = 3;

/// How far sites speak for each other: R over the cloud's rms radius, and A.
struct Reach {
  double place, direction;
  double no_say;  ///< logarithm: less is the measurement's own scatter
};
constexpr std::array<Reach, 2> kReaches = {{{0.8, 0.55, 0.07}, {0.3, 1, 0.1}}};
constexpr double kSurely = 0.015;  // gain a fit by which the second must be ahead

/// How much what lies `d` off the mean pulls it.
template <class T>
auto pull(const T& d) {
  return d.max(-kBelow).min(kAbove);
}

float pull(float d) {
  return std::clamp(d, -kBelow, kAbove);
}

/// What it costs to be `d` off: its derivative is the pull.
float cost(float d) {
  const float end = std::abs(pull(d));
  return end * (std::abs(d) - end / 2);
}

/// What the fits say, by coordinate.
struct Heard {
  Eigen::ArrayXf x, y, z, nx, ny, nz, radius;
  Eigen::ArrayXf about;   ///< logarithm of what the sites around show
  Eigen::ArrayXf value;   ///< logarithm of the variance over the typical one, without bias
  Eigen::ArrayXf weight;  ///< 0: says nothing
  float mean = 0;         ///< of the values

  explicit Heard(const NoiseSites& sites) {
    const auto n = Eigen::Index(sites.at.size());
    for (Eigen::ArrayXf* a : {&x, &y, &z, &nx, &ny, &nz, &radius, &about, &value, &weight}) a->setZero(n);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& p : sites.at) middle += p / double(n);
    double square = 0;
    for (const auto& p : sites.at) square += (p - middle).squaredNorm() / double(n);
    const double extent = std::sqrt(square);
    if (!(extent > 0)) return;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Scatter& fit = sites.fits[std::size_t(i)];
      const Eigen::Vector3f at = ((sites.at[std::size_t(i)] - middle) / extent).cast<float>();
      const Eigen::Vector3f normal = fit.normal.cast<float>();
      x[i] = at.x(), y[i] = at.y(), z[i] = at.z();
      nx[i] = normal.x(), ny[i] = normal.y(), nz[i] = normal.z();
      radius[i] = float(fit.radius / extent);
      about[i] = std::log(std::max(std::numeric_limits<float>::min(), float(sites.sigma[std::size_t(i)])));
    }
    hear(sites);
  }

  /// Those do not speak any more.
  void silence(const std::vector<char>& sites) {
    for (std::size_t i = 0; i < sites.size(); ++i)
      if (sites[i] != 0) weight[Eigen::Index(i)] = 0;
    find_mean();
  }

 private:
  /// Enters values and weights.
  void hear(const NoiseSites& sites) {
    const std::size_t n = sites.at.size();
    std::vector<double> variance(n, 0), said;
    for (std::size_t i = 0; i < n; ++i) {
      const double seen = says(sites.fits[i]) ? sites.fits[i].variance * (1 - sites.shape[i]) : 0;
      variance[i] = std::max(seen, sites.floor[i] * sites.floor[i]);
      if (speaks(sites, i)) said.push_back(variance[i]);
    }
    const double typical = said.empty() ? 0 : quantile(said, 0.5);
    if (!(typical > 0)) return;
    for (std::size_t i = 0; i < n; ++i) {
      if (!speaks(sites, i)) continue;
      const auto k = Eigen::Index(i);
      double f = sites.fits[i].freedom;
      value[k] = float(std::log(std::clamp(variance[i] / typical, 1 / kFar, kFar)));
      if (!says(sites.fits[i]))
        f = 1;  // of a floor alone
      else if (variance[i] > sites.floor[i] * sites.floor[i])
        value[k] += float(1 / f + 1 / (3 * f * f));  // E log(chi-square / f), but for the sign
      weight[k] = float(sites.area[i] * f / (f + 2));
    }
    find_mean();
  }

  /// Enters the mean of those that say something.
  void find_mean() {
    std::vector<Weighed> all;
    for (Eigen::Index i = 0; i < value.size(); ++i)
      if (weight[i] > 0) all.push_back({value[i], weight[i]});
    if (all.empty()) return;
    mean = float(quantile(all, 0.5));
    for (int round = 0; round < kFieldRounds; ++round)
      mean += (weight * pull(value - mean)).sum() / weight.sum();
  }

  static bool speaks(const NoiseSites& sites, std::size_t i) {
    return sites.speaks[i] && ((says(sites.fits[i]) && !sites.full[i]) || sites.floor[i] > 0);
  }
};

/// The mean around each site, and how well it predicts those that it does not overlap with.
struct Means {
  Eigen::ArrayXf value;   ///< as of the fits
  Eigen::ArrayXf of_all;  ///< the same with calmer ones around louder
  double gain = 0;        ///< a fit, of cost against that of one figure for all
  double no_say = 0;      ///< as of the reach
};

/// The sites that have a weight, and what is beside them: eight after the other, and the last fewer than
/// eight. Sums over them are the same bits as over all, since only zeros are missing and the others keep
/// their lanes.
class FewOfAll {
 public:
  explicit FewOfAll(Eigen::Index all) : all_(all) {}
  /// Those above zero.
  void find(const Eigen::ArrayXf& weight) {
    eights_.clear();
    for (Eigen::Index at = 0; at + kEight <= all_; at += kEight)
      if (weight.segment<kEight>(at).maxCoeff() > 0) eights_.push_back(at);
  }
  void pick(const Eigen::ArrayXf& of_all, Eigen::ArrayXf& few) const {
    const Eigen::Index last = all_ % kEight;
    few.resize(kEight * Eigen::Index(eights_.size()) + last);
    for (std::size_t k = 0; k < eights_.size(); ++k)
      few.segment<kEight>(kEight * Eigen::Index(k)) = of_all.segment<kEight>(eights_[k]);
    few.tail(last) = of_all.tail(last);
  }

 private:
  static constexpr int kEight = 8;
  Eigen::Index all_;
  std::vector<Eigen::Index> eights_;
};

Means around(const Heard& heard, const Reach& reach, const Context& context) {
  const Eigen::Index n = heard.x.size();
  Means means;
  means.value.resize(n);
  means.of_all.resize(n);
  Eigen::ArrayXd gain = Eigen::ArrayXd::Zero(n);
  const auto near = float(1 / (reach.place * reach.place)),
             alike = float(1 / (reach.direction * reach.direction));
  const auto louder = float(1 / (std::log(kMuchLouder) * std::log(kMuchLouder)));
  for_blocks(context, std::size_t(n), 64, [&](std::size_t begin, std::size_t end) {
    Eigen::ArrayXf squared(n), like(n);
    Eigen::ArrayXf w, off, value, weight, about, radius;  // of few
    FewOfAll few(n);
    const auto mean_by = [&] {
      const float weights = w.sum() + kCloud;
      float mean = ((w * value).sum() + kCloud * heard.mean) / weights;
      for (int round = 0; round < kFieldRounds; ++round) {
        off = w * pull(value - mean);
        mean += (off.sum() + kCloud * pull(heard.mean - mean)) / weights;
      }
      return mean;
    };
    for (auto i = Eigen::Index(begin); i < Eigen::Index(end); ++i) {
      squared =
          (heard.x - heard.x[i]).square() + (heard.y - heard.y[i]).square() + (heard.z - heard.z[i]).square();
      like = (heard.nx * heard.nx[i] + heard.ny * heard.ny[i] + heard.nz * heard.nz[i]).square();
      like = 1 - near * squared - alike * (1 - like);
      few.find(like);
      few.pick(like, off);
      few.pick(heard.weight, weight);
      few.pick(heard.value, value);
      few.pick(heard.about, about);
      w = off.max(0.0F).square() * weight;
      means.of_all[i] = mean_by();
      few.pick(like, off);
      w = (off - louder * (heard.about[i] - about).max(0.0F).square()).max(0.0F).square() * weight;
      const float mean = means.value[i] = mean_by();
      if (!(heard.weight[i] > 0)) continue;
      few.pick(squared, off);
      few.pick(heard.radius, radius);
      w = (off > (radius + heard.radius[i]).square()).select(w, 0);
      off = w * pull(value - mean);
      const float predicted = mean + (off.sum() + kCloud * pull(heard.mean - mean)) / (w.sum() + kCloud);
      gain[i] =
          double(heard.weight[i] * (cost(heard.value[i] - heard.mean) - cost(heard.value[i] - predicted)));
    }
  });
  means.gain = gain.sum() / double(heard.weight.sum());
  means.no_say = reach.no_say;
  return means;
}

/// By site: the mean around it over the figure.
std::vector<double> mean_around(const Heard& heard, const NoiseSites& sites, double figure,
                                const Context& context) {
  std::vector<double> relative(sites.at.size(), 1);
  if (!(heard.weight.sum() > 0)) return relative;
  Means best;
  for (const Reach& reach : kReaches) {
    Means means = around(heard, reach, context);
    if (best.value.size() == 0 || means.gain > best.gain + kSurely) best = std::move(means);
  }
  // What one is: what the field has where sites show about the figure. But where some are louder than others
  // the figure may be between the two, and the field another than they show: then what it has where they show
  // the figure, in the middle of all. Where depths come in steps these make most of the difference, unless it
  // is large.
  std::vector<double> alike, shown, times;
  for (std::size_t i = 0; i < relative.size(); ++i) {
    const auto k = Eigen::Index(i);
    const double of_figure = sites.sigma[i] / figure;
    if (of_figure < kAlike && kAlike * of_figure > 1) alike.push_back(best.of_all[k]);
    if (!sites.speaks[i] || !(std::abs(std::log(of_figure)) < std::log(kFar) / 2)) continue;
    shown.push_back(best.value[k] - 2 * std::log(of_figure));
    times.push_back(of_figure);
  }
  if (alike.empty()) return relative;
  double typical = quantile(alike, 0.5);
  if (!times.empty() && (!sites.in_steps || quantile(times, 0.9) > kMuchLouder * quantile(times, 0.1)))
    if (const double middle = quantile(shown, 0.5); std::abs(middle - typical) > 2 * std::log(kSameNoise))
      typical = middle;
  for (std::size_t i = 0; i < relative.size(); ++i) {
    // Half: of the standard deviation, not of the variance.
    const double d = (best.value[Eigen::Index(i)] - typical) / 2;
    if (std::abs(d) > best.no_say) relative[i] = std::exp(d - best.no_say * best.no_say / d);
  }
  return relative;
}

}  // namespace

std::vector<double> relative_noise(const NoiseSites& sites, double figure, const Context& context) {
  Heard heard(sites);
  std::vector<double> relative = mean_around(heard, sites, figure, context);
  const auto at_most = [&](std::size_t s) { return std::max(sites.most[s], sites.floor[s]) / figure; };
  std::vector<char> calm(relative.size(), 0);
  for (std::size_t s = 0; s < calm.size(); ++s) calm[s] = char(kLouder * at_most(s) < relative[s]);
  if (std::find(calm.begin(), calm.end(), 1) == calm.end()) return relative;
  heard.silence(calm);
  relative = mean_around(heard, sites, figure, context);
  for (std::size_t s = 0; s < calm.size(); ++s)
    if (calm[s] != 0) relative[s] = at_most(s);
  return relative;
}

}  // namespace rfsmooth::rfs_mesh
