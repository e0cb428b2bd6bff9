/// A cloud, options and a flow out of any bytes, and what must hold of them: the fuzz target `denoise` runs
/// it on what libFuzzer finds, the test program on the committed corpus.
///
/// The bytes: kind of coordinates; flow; one byte for each option that the flow takes (below 128: left to its
/// default, else a place in its range); the rest are points.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <rfsmooth/denoise.h>
#include <rfsmooth/mesh.h>

#include "rfs_mesh/points.h"

namespace rfsmooth::fuzz {

/// Reads a buffer byte by byte; zeros after its end.
class Reader {
 public:
  Reader(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  std::size_t left() const { return left_; }
  std::uint8_t byte() {
    std::uint8_t value = 0;
    bytes(&value, 1);
    return value;
  }
  void bytes(void* out, std::size_t n) {
    std::memset(out, 0, n);
    const std::size_t take = std::min(n, left_);
    if (take > 0) std::memcpy(out, data_, take);
    data_ += take;
    left_ -= take;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// Visits a `describe` table and sets what the bytes say.
class SetOptions {
 public:
  explicit SetOptions(Reader& reader) : reader_(reader) {}

  template <class T>
  void operator()(const OptionInfo& info, T& value) {
    if (info.name == "outliers" || info.name.rfind("sheets-", 0) == 0) return;
    const std::uint8_t byte = reader_.byte();
    if (byte < 128) return;
    set(info, (byte - 128) / 127.0, value);
  }

 private:
  /// A share of the legal range; of wide ones evenly by magnitude.
  static double between(double low, double high, double share) {
    if (!(high - low > 1000)) return low + share * (high - low);
    if (share == 0) return low;
    low = std::max(low, 1e-3);
    return low * std::pow(std::min(high, 1e6) / low, share);
  }
  static void set(const OptionInfo&, double share, bool& value) { value = share < 0.5; }
  static void set(const OptionInfo& info, double share, int& value) {
    // Work grows with counts: a few are enough to find what is wrong.
    const double high = info.name == "iterations" ? 4 : std::min(info.max, 200.0);
    value = int(between(info.min, high, share));
  }
  static void set(const OptionInfo& info, double share, double& value) {
    value = between(info.min, info.max, share);
  }
  static void set(const OptionInfo& info, double share, Length& value) {
    value = {between(info.min, info.max, share), share < 0.75};
  }
  template <class Enumeration, std::enable_if_t<std::is_enum_v<Enumeration>, int> = 0>
  static void set(const OptionInfo& info, double share, Enumeration& value) {
    value = Enumeration(std::min(std::size_t(share * double(info.choices.size())), info.choices.size() - 1));
  }
  static void set(const OptionInfo&, double share, std::optional<Eigen::Vector3d>& value) {
    if (share < 0.5) value = Eigen::Vector3d(1, 0.5, -0.25);
  }
  template <class T>
  static void set(const OptionInfo& info, double share, std::optional<T>& value) {
    T chosen{};
    set(info, share, chosen);
    value = chosen;
  }

  Reader& reader_;
};

inline std::vector<double> read_points(Reader& reader, std::uint8_t kind) {
  constexpr std::size_t kMostPoints = 120;
  const double origin = (kind & 4) != 0 ? 4649776.5 : 0;
  std::vector<double> xyz;
  while (reader.left() > 0 && xyz.size() < 3 * kMostPoints) {
    double value = 0;
    switch (kind & 3) {
      case 0: {  // a coarse lattice: coincident, collinear and coplanar points
        value = std::int8_t(reader.byte());
        break;
      }
      case 1: {
        std::int16_t v = 0;
        reader.bytes(&v, 2);
        value = v / 256.0;
        break;
      }
      case 2: {
        float v = 0;
        reader.bytes(&v, 4);
        value = v;
        break;
      }
      default:
        reader.bytes(&value, 8);
    }
    xyz.push_back(value + origin);
  }
  xyz.resize(xyz.size() / 3 * 3);
  return xyz;
}

[[noreturn]] inline void found(const std::string& what) {
  std::fprintf(stderr, "found: %s\n", what.c_str());
  std::abort();
}

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

/// A failure must say what is wrong and leave the cloud alone.
inline void check_failure(const Error& error, const std::vector<double>& before,
                          const std::vector<double>& after) {
  if (error.code != ErrorCode::usage && error.code != ErrorCode::no_usable_points)
    found("unexpected failure: " + error.message);
  if (error.message.empty()) found("a failure without a message");
  if (!same_bits(before, after)) found("a failure that changed the cloud");
}

inline void check_result(const std::vector<double>& before, const std::vector<double>& after) {
  for (std::size_t i = 0; i < before.size(); i += 3) {
    const bool finite =
        std::isfinite(before[i]) && std::isfinite(before[i + 1]) && std::isfinite(before[i + 2]);
    if (!finite && std::memcmp(&before[i], &after[i], 3 * sizeof(double)) != 0)
      found("a point that is not finite was changed");
    if (finite && !(std::isfinite(after[i]) && std::isfinite(after[i + 1]) && std::isfinite(after[i + 2])))
      found("a finite point is no longer finite");
  }
}

inline void cloud_to_flow(const std::uint8_t* data, std::size_t size) {
  Reader reader(data, size);
  const std::uint8_t kind = reader.byte();
  DenoiseOptions options;
  options.flow.flow = rfsmooth::flows()[reader.byte() % rfsmooth::flows().size()];
  DenoiseOptions::describe(options, SetOptions(reader));
  // Most bytes give some modifier without the one it needs, which is refused before anything is done.
  if (!validate(options.flow).ok()) options.flow.modifiers = {};
  int& steps = iterations(options.flow.flow);
  steps = std::min(steps, 4);
  const std::vector<double> before = read_points(reader, kind);
  const std::size_t n = before.size() / 3;
  Context one;
  one.threads = 1;

  std::vector<double> after = before;
  const auto done = rfsmooth::denoise(after.data(), n, options, one);
  if (!done.ok()) return check_failure(done.error(), before, after);
  check_result(before, after);
  // What the report says was done gives the same bytes, with another number of threads too.
  Context two;
  two.threads = 2;
  std::vector<double> again = before;
  const auto repeated = rfsmooth::denoise(again.data(), n, done.value().effective, two);
  if (!repeated.ok()) found("the effective options are refused: " + repeated.error().message);
  if (!same_bits(after, again)) found("the effective options give other bytes");

  // The stages on their own.
  const auto cloud = rfs_mesh::make_working_cloud(before.data(), n, one);
  if (!cloud.ok()) found("no working cloud: " + cloud.error().message);
  auto connection = rfsmooth::connect(cloud.value().points, options.connect, one);
  if (!connection.ok()) found("not connected: " + connection.error().message);
  Mesh& mesh = connection.value().mesh;
  for (const std::string& line : rfsmooth::check(mesh)) found("the mesh: " + line);
  const Positions start = mesh.positions;
  const auto smoothed = rfsmooth::smooth(mesh, options.flow, one);
  if (!smoothed.ok() && mesh.positions != start) found("a failed flow moved the mesh");
  for (const std::string& line : rfsmooth::check(mesh)) found("the smoothed mesh: " + line);
}

}  // namespace rfsmooth::fuzz
