#include "smoothing/automatic/patches/mixture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <Eigen/Core>

#include <rfsmooth/statistics.h>

#include "base/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr int kMostCandidates = 1 + int(Statistics::Pass::kMostScales);
constexpr int kMixtureRounds = 3;  // of expectation maximisation: a fourth changes the third digit

// Of the variance that a scale leaves, what it differs by from the one before. It follows from how patches
// average: 0.5 to 0.68 were measured of white noise of 0.3 to 2 spacings on spheres and tori. The least of
// these: nobody should believe that less is left than there is.
constexpr double kDifference = 0.5;

using CandidateWeights = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostCandidates, 1>;

}  // namespace

Mixture::Mixture(std::vector<float> first) : evidence_(first.size(), 0) {
  std::vector<float> own(first.size(), 1);
  candidates_.push_back({std::move(first), std::move(own), evidence_});
}

void Mixture::add(std::vector<float> height, std::vector<float> own, std::vector<float> gain,
                  const Context& context) {
  if (candidates_.size() == kMostCandidates) throw std::length_error("Mixture: more than 16 candidates");
  for_each_index(context, gain.size(), [&](std::size_t i) {
    const bool here = !std::isnan(gain[i]);
    if (here) evidence_[i] += gain[i];
    gain[i] = here ? evidence_[i] : -std::numeric_limits<float>::infinity();
  });
  candidates_.push_back({std::move(height), std::move(own), std::move(gain)});
}

Left Mixture::average(std::vector<float>& height, std::vector<float>& own, std::vector<double>& found,
                      const std::vector<float>& say, const std::vector<double>& sigma,
                      const Context& context) {
  const std::size_t n = evidence_.size(), count = candidates_.size();
  const auto rows = Eigen::Index(count);
  // From here on e^(evidence - the largest): the exponential is the dear part.
  for_each_index(context, n, [&](std::size_t i) {
    float largest = candidates_[0].evidence[i];
    for (const Candidate& c : candidates_) largest = std::max(largest, c.evidence[i]);
    for (Candidate& c : candidates_) c.evidence[i] = std::exp(c.evidence[i] - largest);
  });
  const auto weights = [&](std::size_t i, const CandidateWeights& shares) {
    CandidateWeights w(rows);
    for (std::size_t s = 0; s < count; ++s)
      w[Eigen::Index(s)] = shares[Eigen::Index(s)] * double(candidates_[s].evidence[i]);
    return CandidateWeights(w * (1 / w.sum()));
  };
  const double votes = sum_over(context, n, 0.0, [&](std::size_t i) { return double(say[i]); });
  CandidateWeights shares = CandidateWeights::Constant(rows, 1 / double(count));
  const bool known = found.size() == count;
  if (known) shares = Eigen::Map<const Eigen::ArrayXd>(found.data(), rows);
  for (int round = 0; !known && round < kMixtureRounds; ++round) {
    const CandidateWeights sum =
        sum_over(context, n, CandidateWeights(CandidateWeights::Zero(rows)),
                 [&](std::size_t i) { return CandidateWeights(double(say[i]) * weights(i, shares)); });
    // A scale that no point wants may still be right for one.
    shares = sum.max(1) / std::max(1.0, votes);
  }
  found.assign(shares.data(), shares.data() + rows);
  height.resize(n);
  own.resize(n);
  const Eigen::Array2d left = sum_over(context, n, Eigen::Array2d(0, 0), [&](std::size_t i) {
    const CandidateWeights w = weights(i, shares);
    const double variance = sigma[i] * sigma[i];
    double mixed = 0, mixed_own = 0;
    Eigen::Array2d off(0, 0);
    for (std::size_t s = 0; s < count; ++s) {
      const Candidate& c = candidates_[s];
      const double weight = w[Eigen::Index(s)];
      mixed += weight * double(c.height[i]);
      mixed_own += weight * double(c.own[i]);
      if (s < 2 || !(candidates_[s - 1].evidence[i] > 0)) {
        off[0] += weight * double(c.own[i]) * variance;
      } else {
        const double differs = double(c.height[i]) - double(candidates_[s - 1].height[i]);
        off[1] += weight * std::min(differs * differs / kDifference, variance);
      }
    }
    height[i] = float(mixed);
    own[i] = float(mixed_own);
    return off;
  });
  return {left[0] / double(n), left[1] / double(n)};
}

}  // namespace rfsmooth::smoothing
