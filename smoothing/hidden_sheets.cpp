#include "rfsmooth/smoothing/hidden_sheets.h"

#include <algorithm>
#include <cmath>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::smoothing {

namespace {

// From the development shapes at 10,000 and 50,000 points, noise of 1 to 3 %, also along the ray and with
// strays: where walls are hidden (rotor) the evidence is 8.4 to 180, elsewhere at most 4.2.
constexpr double kEvidence = 7;         // nats
constexpr double kLouder = 1.3;         // v / c from which a place counts
constexpr double kLoudest = 4;          // v: beyond, one sees two sheets
constexpr double kLeastShare = 0.05;    // of the cloud
constexpr double kMostOwn = 0.25;       // points that were hardly smoothed say nothing
constexpr double kPrior = 0.15;         // standard deviation of ln c
constexpr int kRounds = 4, kAgain = 4;  // local means in all 16, over some 500 points
constexpr double kFar = 4;              // sigma: residuals beyond belong to strays

/// The sum of the logarithms of the ratios of the likelihoods: two sheets against louder noise.
class ForSheets {
 public:
  void add(double residual, double squared_distance, double variance) {
    const double all = variance + squared_distance, square = residual * residual, per_variance = 1 / variance,
                 x = std::sqrt(squared_distance) * std::abs(residual) * per_variance;
    // log cosh x = x + log((1 + e^-2x) / 2)
    const double near_one = 0.5 + 0.5 * double(std::exp(float(-2 * x)));
    sum_ += x - 0.5 * ((square + squared_distance) * per_variance - square / all);
    product_ *= all * per_variance * near_one * near_one;
    if (!(product_ > kLow && product_ < kHigh)) gather();
  }
  double sum() {
    gather();
    return sum_;
  }

 private:
  static constexpr double kLow = 1e-200, kHigh = 1e200;  // one more factor stays within the numbers
  /// Logarithms are taken of products: of one where it would have been hundreds.
  void gather() {
    sum_ += 0.5 * std::log(product_);
    product_ = 1;
  }
  double sum_ = 0, product_ = 1;
};

struct Sum {
  double evidence = 0;
  std::size_t points = 0;
  Sum& operator+=(const Sum& other) {
    evidence += other.evidence;
    points += other.points;
    return *this;
  }
};

/// Over all c; `v` are the residuals' local means.
HiddenSheets best_evidence(const std::vector<float>& residual, const std::vector<float>& own,
                           const std::vector<float>& v, const Context& context) {
  const std::size_t n = v.size();
  HiddenSheets best;
  for (double c = 1.1; c > 0.55; c *= 0.9) {
    const Sum sum = reduce_blocks(
        context, n, Sum(),
        [&](std::size_t begin, std::size_t end) {
          ForSheets evidence;
          Sum part;
          for (std::size_t i = begin; i < end; ++i) {
            const double mean = double(v[i]), share = double(own[i]);
            if (share > kMostOwn || mean < kLouder * c || mean > kLoudest) continue;
            evidence.add(double(residual[i]), mean - c, c * (1 - 2 * share));
            ++part.points;
          }
          part.evidence = evidence.sum();
          return part;
        },
        [](Sum a, const Sum& b) { return a += b; });
    const double unlikely = std::log(c) / kPrior, evidence = sum.evidence - unlikely * unlikely / 2;
    if (double(sum.points) < kLeastShare * double(n) || evidence <= best.evidence) continue;
    best.evidence = evidence;
    best.variance = c;
  }
  return best;
}

}  // namespace

HiddenSheets split_hidden_sheets(const HeightField& field, double sigma, std::vector<float>& height,
                                 std::vector<float>& own, const Context& context) {
  const std::size_t n = field.size();
  std::vector<float> residual(n), v(n);
  for_each_index(context, n, [&](std::size_t i) {
    residual[i] = float(std::clamp((field.height(i) - double(height[i])) / sigma, -kFar, kFar));
    v[i] = residual[i] * residual[i] + 2 * own[i];
  });
  // A mean over few points follows its own points and makes any noise look like two sheets: where it does not
  // even then, one over more would not either.
  HiddenSheets found;
  for (int round = 0; round < kRounds; ++round) {
    for (int again = 0; again < kAgain; ++again) v = field.local_mean(v, context);
    found = best_evidence(residual, own, v, context);
    if (found.evidence < kEvidence) return found;
  }
  const double c = found.variance;
  found.split = sum_over(context, n, std::size_t(0), [&](std::size_t i) {
    const double mean = double(v[i]), share = double(own[i]);
    if (mean < kLouder * c) return std::size_t(0);
    const double d = std::sqrt(mean - c), side = std::tanh(d * double(residual[i]) / c);
    height[i] = float(double(height[i]) + sigma * d * side);
    own[i] = float(share + (1 - share) * d * d / c * (1 - side * side));
    return std::size_t(1);
  });
  return found;
}

}  // namespace rfsmooth::smoothing
