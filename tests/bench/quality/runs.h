/// Running tools over the cases of the benchmark.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/bench/quality/data/settings.h"
#include "tests/bench/quality/data/store.h"

namespace rfsmooth::bench {

/// What a run of the program covers.
struct Plan {
  std::vector<std::string> shapes = shape_names();
  std::vector<std::size_t> sizes = {10000, 50000};
  std::vector<Noise> noises;  ///< see standard_noises
  int most_tier = 2;          ///< peers up to this tier (PeerSetting::tier)
  int threads = 0;
  std::filesystem::path cache;
};

/// Gaussian 1, 2, 3 %; along the ray 2 %; Gaussian 1 % with 1 % outliers.
std::vector<Noise> standard_noises();

/// Samples and truths of a plan, built when first asked for and kept.
class Cases {
 public:
  explicit Cases(const Plan& plan) : plan_(plan) {}
  Case make(const std::string& shape, std::size_t size, const Noise& noise);
  const Truth& truth(const std::string& shape, std::size_t size);

 private:
  std::shared_ptr<const Sample> sample(const std::string& shape, std::size_t size);
  const Plan& plan_;
  std::map<std::pair<std::string, std::size_t>, std::shared_ptr<const Sample>> samples_;
  std::map<std::pair<std::string, std::size_t>, Truth> truths_;
};

/// Rows of one size and noise: tool -> shape -> row. A tool that could not be run on a shape has no row
/// there.
using Cell = std::map<std::string, std::map<std::string, Row>>;

/// The peers' rows of a cell, as far as they are in the cache.
Cell cached_peers(const Plan& plan, Cases& cases, std::size_t size, const Noise& noise);

/// Runs what the cache does not have yet: quick peers on all cells first, slow ones last. A line to stderr
/// per run; a peer that throws is named there and has no row. Returns the number of runs made.
std::size_t run_peers(const Plan& plan, Cases& cases);

/// What a peer makes of a cloud: from the store in `cache` if it is there, else kept in it. For clouds that
/// are measured by other means than a Truth. \throw std::invalid_argument if no peer is called so.
peers::Smoothed peer_result(const std::filesystem::path& cache, const Positions& points,
                            const std::string& setting, int threads);

}  // namespace rfsmooth::bench
