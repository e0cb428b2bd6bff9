/// Every setting of every peer that the quality benchmark tries.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/bench/peers/peers.h"

namespace rfsmooth::bench {

struct PeerSetting {
  std::string family;  ///< "CGAL jet"
  std::string name;    ///< "CGAL jet k 48 x2"
  int tier = 0;        ///< 0: the strong and quick ones, run first; 1; 2: slow
  std::string base;    ///< name of the setting whose result this one starts from; empty = the noisy cloud
  std::function<peers::Smoothed(const Positions& points, int threads)> run;
};

/// The peers at the settings that their users find without looking: chosen once, for everything.
inline constexpr const char* kFixedMls = "PCL MLS k 48";
inline constexpr const char* kFixedJet = "CGAL jet k 24";

/// In the order of the issue; a `base` comes before those that build on it.
const std::vector<PeerSetting>& peer_settings();

/// By its name. \throw std::invalid_argument if there is none.
const PeerSetting& peer_setting(const std::string& name);

}  // namespace rfsmooth::bench
