#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <rfsmooth/mesh.h>
#include <rfsmooth/statistics.h>

namespace rfsmooth {

namespace {

bool is_length(double v) {
  return v >= 0 && std::isfinite(v);
}

bool are_lengths(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), is_length);
}

/// At least one, and no more than an index can tell apart.
bool is_number_of_points(std::size_t n) {
  return n >= 1 && n < kNone;
}

/// Of any cloud so many thinnings leave one point.
bool is_scale(const Statistics::Scale& scale) {
  return is_number_of_points(scale.members) && scale.thinnings >= 1 &&
         scale.thinnings <= std::numeric_limits<std::uint64_t>::digits;
}

bool is_box(const Statistics::Box& box) {
  return box.low.allFinite() && box.high.allFinite() && (box.low.array() <= box.high.array()).all();
}

}  // namespace

std::vector<std::string> check(const Statistics& statistics) {
  std::vector<std::string> wrong;
  const auto expect = [&](bool right, std::string what) {
    if (!right) wrong.push_back(std::move(what));
  };
  if (statistics.box) expect(is_box(*statistics.box), "box: its corners are not the lowest and the highest");
  if (const auto& noise = statistics.noise) {
    expect(is_length(noise->sigma) && is_length(noise->spacing) && is_length(noise->apart) &&
               is_length(noise->step) && are_lengths(noise->at_sites) && are_lengths(noise->spacing_at_sites),
           "noise: a sigma, a spacing or the step of depths is no length");
    expect(is_number_of_points(noise->across.value_or(1)) && noise->shared >= 1 && is_length(noise->shared),
           "noise: what points share it, or reach across, is no number of points");
    const std::size_t sites = noise->sites.size(), at = noise->at_sites.size(),
                      spaced = noise->spacing_at_sites.size(), told = noise->told_at_sites.size();
    expect(at == sites && (spaced == 0 || spaced == sites) && (told == 0 || told == sites),
           fmt::format("noise: sigma at {}, spacing at {} and what is told at {} of {} sites", at, spaced,
                       told, sites));
  }
  for (const Statistics::Pass& pass : statistics.passes) {
    expect(std::all_of(pass.scales.begin(), pass.scales.end(), is_scale) &&
               (!pass.narrow || is_scale(*pass.narrow)),
           "passes: a scale without members, or without 1 to 64 thinnings");
    expect(
        pass.scales.size() <= Statistics::Pass::kMostScales,
        fmt::format("passes: {} scales, the most are {}", pass.scales.size(), Statistics::Pass::kMostScales));
    expect(
        pass.shares.empty() || pass.shares.size() == pass.scales.size() + 1,
        fmt::format("passes: {} shares for the data and {} scales", pass.shares.size(), pass.scales.size()));
  }
  return wrong;
}

}  // namespace rfsmooth
