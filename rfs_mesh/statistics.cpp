#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <rfsmooth/mesh.h>
#include <rfsmooth/statistics.h>

#include "rfs_mesh/levels.h"
#include "rfs_mesh/points.h"

namespace rfsmooth {

namespace {

constexpr double kShortest = 1e-150;  // world units: what is shorter has a square without its digits

// The work of a law of tails grows with how wide they are (smoothing/automatic/tails); those of clouds are
// three to ten times as wide.
constexpr double kWidestTails = 1e4;

/// What is wrong, one line each.
struct Wrong {
  std::vector<std::string> lines;
  void expect(bool right, std::string what) {
    if (!right) lines.push_back(std::move(what));
  }
};

/// NaN is not.
bool is_within(double v, double low, double high) {
  return v >= low && v <= high;
}

bool is_length(double v) {
  return v == 0 || is_within(v, kShortest, rfs_mesh::kLargestSide);
}

bool is_some_length(double v) {
  return v > 0 && is_length(v);
}

bool is_amount(double v) {
  return v >= 0 && std::isfinite(v);
}

template <class T, class Is>
bool are(const std::vector<T>& values, Is&& is) {
  return std::all_of(values.begin(), values.end(), is);
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

/// Of a cloud around its origin.
bool is_site(const Eigen::Vector3d& p) {
  return (p.array().abs() <= rfs_mesh::kLargestSide).all();
}

void check_sites(const NoiseModel& noise, Wrong& wrong) {
  const std::size_t sites = noise.sites.size(), at = noise.at_sites.size(),
                    spaced = noise.spacing_at_sites.size(), told = noise.told_at_sites.size(),
                    shared = noise.shared_at_sites.size();
  const auto all_or_none = [&](std::size_t of) { return of == 0 || of == sites; };
  wrong.expect(
      at == sites && all_or_none(spaced) && all_or_none(told) && all_or_none(shared),
      fmt::format("noise: sigma at {}, spacing at {}, what is told at {} and what is shared at {} of "
                  "{} sites",
                  at, spaced, told, shared, sites));
  wrong.expect(are(noise.sites, is_site), "noise: a site is farther away than any cloud is large");
  wrong.expect(are(noise.at_sites, is_length) && are(noise.spacing_at_sites, is_some_length),
               "noise: at a site sigma is no length, or the spacing none above 0");
  wrong.expect(are(noise.told_at_sites, [](double v) { return is_within(v, 0, 1); }),
               "noise: what is told at a site is not from 0 to 1");
  wrong.expect(are(noise.shared_at_sites, [](double v) { return is_within(v, 1, kNone); }),
               "noise: what points share it at a site is no number of points");
}

void check_noise(const NoiseModel& noise, Wrong& wrong) {
  wrong.expect(
      is_length(noise.sigma) && is_length(noise.spacing) && is_length(noise.apart) && is_length(noise.step) &&
          is_length(noise.rounding),
      "noise: a sigma, a spacing, what points keep apart, the step of depths or its rounding is no length");
  wrong.expect(!(noise.sigma > 0) || (noise.spacing > 0 && !noise.sites.empty()),
               "noise: a sigma above 0, but no site or no spacing above 0");
  wrong.expect(is_within(noise.shape, 0, 1), "noise: shape is no share");
  wrong.expect(
      noise.piece >= rfs_mesh::kNarrowestPatch && noise.piece < kNone && is_within(noise.shared, 1, kNone),
      "noise: what points share it or are a piece of the surface is no number of points");
  check_sites(noise, wrong);
}

void check_tails(const Statistics::Tails& tails, Wrong& wrong) {
  wrong.expect(tails.share >= 0 && tails.share < 1, "tails: share is not from 0 to below 1");
  wrong.expect(is_within(tails.times, 1, kWidestTails), "tails: times is not from 1 to 10,000");
  wrong.expect(tails.narrow > 0 && is_amount(tails.narrow), "tails: narrow is no number above 0");
  wrong.expect(is_amount(tails.together), "tails: together is no number from 0 on");
}

void check_pass(const Statistics::Pass& pass, Wrong& wrong) {
  wrong.expect(are(pass.scales, is_scale) && (!pass.narrow || is_scale(*pass.narrow)),
               "passes: a scale without members, or without 1 to 64 thinnings");
  wrong.expect(
      pass.scales.size() <= Statistics::Pass::kMostScales,
      fmt::format("passes: {} scales, the most are {}", pass.scales.size(), Statistics::Pass::kMostScales));
  if (pass.shares.empty()) return;
  wrong.expect(
      pass.shares.size() == pass.scales.size() + 1,
      fmt::format("passes: {} shares for the data and {} scales", pass.shares.size(), pass.scales.size()));
  wrong.expect(are(pass.shares, is_amount) &&
                   std::any_of(pass.shares.begin(), pass.shares.end(), [](double v) { return v > 0; }),
               "passes: the shares are no numbers from 0 on of which some are above 0");
}

}  // namespace

std::vector<std::string> check(const Statistics& statistics) {
  Wrong wrong;
  if (statistics.box)
    wrong.expect(is_box(*statistics.box), "box: its corners are not the lowest and the highest");
  const std::uint64_t points = statistics.points.value_or(1);
  wrong.expect(points >= 1 && points < std::uint64_t{1} << 53, "points: is no number of points");
  wrong.expect(is_length(statistics.reach.value_or(0)), "reach: is no length");
  wrong.expect(is_length(statistics.spacing.value_or(0)), "spacing: is no length");
  if (const auto& scale = statistics.scale) {
    wrong.expect(is_length(scale->sigma) && is_length(scale->radius), "scale: sigma or radius is no length");
    wrong.expect(scale->neighbours < kNone && (scale->neighbours > 0 || !(scale->sigma > 0)),
                 "scale: neighbours is no number of points");
  }
  if (statistics.noise) check_noise(*statistics.noise, wrong);
  if (statistics.tails) check_tails(*statistics.tails, wrong);
  for (const Statistics::Pass& pass : statistics.passes) check_pass(pass, wrong);
  if (const auto& sheets = statistics.sheets) {
    wrong.expect(std::isfinite(sheets->evidence), "sheets: evidence is no number");
    wrong.expect(sheets->variance > 0 && is_amount(sheets->variance),
                 "sheets: variance is no number above 0");
  }
  double from = 0;
  for (const Statistics::Part& part : statistics.parts) {
    wrong.expect(is_length(part.from) && part.from >= from, "parts: they are not the densest first");
    wrong.expect(part.own.noise && part.own.parts.empty(), "parts: one has no noise, or parts");
    from = part.from;
    for (std::string& line : check(part.own)) wrong.lines.push_back("parts: " + std::move(line));
  }
  return wrong.lines;
}

}  // namespace rfsmooth
