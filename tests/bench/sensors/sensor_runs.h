/// What whole sensors see of a room (clouds/scanner/sensors.h), and what rfsmooth and its peers leave of
/// their noise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "clouds/scanner/sensors.h"
#include "tests/bench/quality/ours.h"

namespace rfsmooth::bench {

inline constexpr double kNear = 4;  ///< metres from the sensor: "near" in the tables

/// What a run covers.
struct SensorPlan {
  std::vector<std::string> sensors;  ///< names
  std::vector<double> levels;        ///< instead of those of each sensor; empty: those
  std::uint64_t seed = 31;           ///< of the noise
  int threads = 2;
  Variant ours = {"rfsmooth", {}};
  std::filesystem::path cache;
};

/// Distances from the points of a cloud to the room, metres; a point farther off than kFar counts as so far.
struct Distances {
  double rms = 0, median = 0;
  double near = 0;  ///< rms of the points that truly are within kNear
};
inline constexpr double kFar = 1;  ///< metres

/// One sensor at one level, measured. Lengths in metres.
struct SensorRow {
  std::size_t points = 0;
  double near_share = 0;  ///< of the points
  Distances raw, ours;
  std::map<std::string, Distances> peers;  ///< by setting; none for a peer that threw
  double noise = 0;                        ///< standard deviation that the report states before ...
  double left = 0;                         ///< ... and after
  double seconds = 0;                      ///< of ours
};

/// All tools get the points rounded to float32, as files hold them. \throw std::runtime_error if ours fails.
SensorRow measure_sensor(const SensorPlan& plan, const clouds::Sensor& sensor);

}  // namespace rfsmooth::bench
