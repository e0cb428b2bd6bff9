/// Clouds with the noise of real scanners (clouds/laws.h), and what rfsmooth and its peers leave of it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "clouds/scanner/laws.h"
#include "tests/bench/quality/ours.h"

namespace rfsmooth::bench {

/// What a run covers.
struct LawPlan {
  std::vector<std::string> laws;  ///< names
  std::vector<std::string> shapes = shape_names();
  std::vector<std::size_t> sizes = {10000, 50000};
  double times = 1;   ///< the noise of every law, x what its row says
  int most_tier = 0;  ///< of the peers that the best setting is chosen from; -1: only the two fixed ones
  bool again = true;  ///< a second run of ours on what the first left
  int threads = 2;
  Variant ours = {"rfsmooth", {}};
  std::filesystem::path cache;
};

/// A law on a shape.
struct LawCase {
  std::string name;  ///< "tails5 rotor 10000"
  std::shared_ptr<const Sample> truth;
  clouds::NoisyCloud cloud;
};

LawCase make_law_case(const LawPlan& plan, const std::string& law, const std::string& shape,
                      std::size_t size);

/// One case, measured. Lengths in spacings of the clean cloud.
struct LawRow {
  std::size_t points = 0;
  double raw = 0, ours = 0;             ///< mean squared distance to the true surface
  std::map<std::string, double> peers;  ///< the same, by setting; none for a peer that threw
  double noise = 0;                     ///< standard deviation that the report states before ...
  double left = 0;                      ///< ... and after
  double again = 0;                     ///< how far a second run moves, over how far the first one did (rms)
  double exact_moved = 0;               ///< rms of the points that had no noise; 0 if there are none
  double exact_share = 0;               ///< how many of these moved by more than 0.05
  double seconds = 0;                   ///< of ours
};

LawRow measure_law_case(const LawPlan& plan, const LawCase& one);

}  // namespace rfsmooth::bench
