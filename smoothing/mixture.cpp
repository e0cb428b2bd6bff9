#include "rfsmooth/smoothing/mixture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Core>

#include "rfsmooth/rfs_mesh/parallel.h"

namespace rfsmooth::smoothing {

namespace {

constexpr int kMost = 16;             // candidates
constexpr int kRounds = 3;            // of expectation maximisation: a fourth changes the third digit
constexpr double kLeastShare = 1e-4;  // a scale that nearly no point wants may still be right for a few

using Weights = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMost, 1>;

}  // namespace

Mixture::Mixture(const std::vector<double>& data) : evidence_(data.size(), 0) {
  candidates_.push_back({{data.begin(), data.end()}, std::vector<float>(data.size(), 1), evidence_});
}

void Mixture::add(const std::vector<double>& height, const std::vector<double>& own,
                  const std::vector<double>& gain, const Context& context) {
  if (candidates_.size() == kMost) throw std::length_error("Mixture: more than 16 candidates");
  Candidate c{{height.begin(), height.end()}, {own.begin(), own.end()}, std::vector<float>(gain.size())};
  for_each_index(context, gain.size(), [&](std::size_t i) {
    if (!std::isnan(gain[i])) evidence_[i] += float(gain[i]);
    c.evidence[i] = std::isnan(gain[i]) ? -std::numeric_limits<float>::infinity() : evidence_[i];
  });
  candidates_.push_back(std::move(c));
}

void Mixture::average(std::vector<double>& height, std::vector<double>& own, const Context& context) const {
  const std::size_t n = evidence_.size(), count = candidates_.size();
  const auto rows = Eigen::Index(count);
  std::vector<float> largest(n);
  for_each_index(context, n, [&](std::size_t i) {
    largest[i] = candidates_[0].evidence[i];
    for (const Candidate& c : candidates_) largest[i] = std::max(largest[i], c.evidence[i]);
  });
  const auto weights = [&](std::size_t i, const Weights& shares) {
    Weights w(rows);
    for (std::size_t s = 0; s < count; ++s)
      w[Eigen::Index(s)] =
          shares[Eigen::Index(s)] * std::exp(double(candidates_[s].evidence[i]) - double(largest[i]));
    return Weights(w / w.sum());
  };
  Weights shares = Weights::Constant(rows, 1 / double(count));
  for (int round = 0; round < kRounds; ++round) {
    const Weights sum =
        sum_over(context, n, Weights(Weights::Zero(rows)), [&](std::size_t i) { return weights(i, shares); });
    shares = (sum / double(n)).max(kLeastShare);
  }
  height.resize(n);
  own.resize(n);
  for_each_index(context, n, [&](std::size_t i) {
    const Weights w = weights(i, shares);
    height[i] = own[i] = 0;
    for (std::size_t s = 0; s < count; ++s) {
      height[i] += w[Eigen::Index(s)] * double(candidates_[s].height[i]);
      own[i] += w[Eigen::Index(s)] * double(candidates_[s].own[i]);
    }
  });
}

}  // namespace rfsmooth::smoothing
