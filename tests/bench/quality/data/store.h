/// Peers' results on disk, found again by what they were made from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/bench/peers/peers.h"
#include "tests/bench/quality/data/measure.h"

namespace rfsmooth::bench {

/// One run of one tool on one case.
struct Row {
  Measures measures;
  double seconds = 0;  ///< wall time of the tool alone
  int threads = 0;
};

/// 64 bits over the bytes of the points (FNV-1a).
std::uint64_t hash_points(const Positions& points);

/// A folder with, per input and setting, the resulting cloud (float coordinates and rows) and its measures. A
/// file appears under its name only when complete, so an interrupted run resumes and two runs may share the
/// folder.
class Store {
 public:
  explicit Store(std::filesystem::path folder);

  std::optional<Row> row(std::uint64_t input, const std::string& setting) const;
  std::optional<peers::Smoothed> cloud(std::uint64_t input, const std::string& setting) const;
  void save(std::uint64_t input, const std::string& setting, const peers::Smoothed& cloud,
            const Row& row) const;

 private:
  std::filesystem::path file(std::uint64_t input, const std::string& setting, const char* ending) const;
  std::filesystem::path folder_;
};

}  // namespace rfsmooth::bench
