#include "smoothing/automatic/left.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "base/chi_square.h"
#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"

namespace rfsmooth::smoothing {

namespace {

using rfs_mesh::kStray;

/// The variance that the residuals tell, over that which was measured.
class ToldByResiduals {
 public:
  ToldByResiduals(const HeightField& field, const std::vector<float>& height, const std::vector<float>& own,
                  const rfs_mesh::NoiseField& noise, const Context& context) {
    const std::size_t n = field.size(), places = std::min(n, rfs_mesh::kSampleOfCloud);
    std::vector<Place> told(places);
    for_each_index(context, places, [&](std::size_t place) {
      told[place] = look(field, height, own, noise, place * n / places);
    });
    told.erase(std::remove_if(told.begin(), told.end(), [](const Place& p) { return !(p.told >= 0); }),
               told.end());
    // Places as loud as each other together, for the measure may be off by more where it is louder.
    std::sort(told.begin(), told.end(), [](const Place& a, const Place& b) {
      return a.sigma != b.sigma ? a.sigma < b.sigma : a.told < b.told;
    });
    const auto many = std::size_t(std::sqrt(double(told.size())));  // places in a part, or nearly
    for (std::size_t begin = 0; begin < told.size();) {
      std::size_t end = begin + 2 * many > told.size() ? told.size() : begin + many;
      while (end < told.size() && told[end].sigma == told[end - 1].sigma) ++end;
      parts_.push_back({told[end - 1].sigma, median(told, begin, end)});
      begin = end;
    }
  }

  /// Where the measured noise is `sigma`.
  double at(double sigma) const {
    if (parts_.empty()) return 1;
    const auto part = std::lower_bound(parts_.begin(), parts_.end(), sigma,
                                       [](const Place& p, double s) { return p.sigma < s; });
    return part == parts_.end() ? parts_.back().told : part->told;
  }

 private:
  struct Place {
    double sigma = 0, told = -1;
  };

  /// sum e^2 / sigma^2 over sum (1 - own) around a point, over the median of that for normal noise.
  static Place look(const HeightField& field, const std::vector<float>& height, const std::vector<float>& own,
                    const rfs_mesh::NoiseField& noise, std::size_t at) {
    constexpr double kMostSquare = kStray * kStray;
    Eigen::Vector4d sums = Eigen::Vector4d::Zero();  // of weights, their squares, e^2 / sigma^2, 1 - own
    const auto add = [&](std::size_t i, double weight) {
      const double e = (field.height(i) - double(height[i])) / noise.local[i];
      sums += weight * Eigen::Vector4d(1, weight, std::min(e * e, kMostSquare), 1 - double(own[i]));
    };
    add(at, 1);
    for (const Index j : field.neighbors()[at])
      add(j, double(same_sheet(field.local()[at].normal.dot(field.local()[j].normal))));
    if (!(2 * sums[3] > sums[0])) return {};  // most of the data stayed, and tell nothing
    // The median of chi-square over its degrees of freedom; neighbours that share their noise are one.
    const double freedom = std::max(1.0, sums[0] * sums[0] / sums[1] / noise.as_one_near(at));
    return {noise.local[at], sums[2] / sums[3] / std::pow(root_of_chi_square(freedom, 0), 3)};
  }

  /// Not the mean: where patches do not follow the shape, residuals tell too much; at least half of the
  /// places are free of that.
  static double median(const std::vector<Place>& places, std::size_t begin, std::size_t end) {
    std::vector<double> told;
    for (std::size_t k = begin; k < end; ++k) told.push_back(places[k].told);
    return rfsmooth::median(told);
  }

  std::vector<Place> parts_;  ///< the loudest of each part, and what all of it tell
};

}  // namespace

double noise_left(const HeightField& field, const std::vector<float>& height, const std::vector<float>& own,
                  const rfs_mesh::NoiseField& noise, const Context& context) {
  const ToldByResiduals told(field, height, own, noise, context);
  // The points that count, their variance, their risk, and their noise.
  const Eigen::Vector4d sums =
      sum_over(context, field.size(), Eigen::Vector4d(0, 0, 0, 0), [&](std::size_t i) {
        const double e = field.height(i) - double(height[i]), share = double(own[i]),
                     measured = noise.local[i] * noise.local[i], square = told.at(noise.local[i]) * measured;
        if (!(std::abs(e) <= noise.reach(i))) return Eigen::Vector4d(0, 0, 0, 0);
        return Eigen::Vector4d(1, share * square, e * e + (2 * share - 1) * square, measured);
      });
  if (!(sums[0] > 0)) return noise.sigma;
  return std::sqrt(std::min(std::max({0.0, sums[1], sums[2]}), sums[3]) / sums[0]);
}

}  // namespace rfsmooth::smoothing
