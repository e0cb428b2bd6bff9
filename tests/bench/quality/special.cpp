#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/bench/quality/goals.h"

namespace rfsmooth::bench {
namespace {

constexpr std::size_t kPoints = 10000;

bool same_bytes(const Positions& a, const Positions& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Eigen::Vector3d)) == 0;
}

}  // namespace

void print_no_harm(const Plan& plan, Cases& cases, const Variant& variant) {
  std::size_t runs = 0, above = 0;
  double worst = 0;
  std::string where;
  for (const std::size_t size : plan.sizes)
    for (const auto& shape : plan.shapes) {
      const Case clean = cases.make(shape, size, {});
      const Moves m = moves(clean.noisy, run_ours(clean.noisy, variant, plan.threads).points);
      const double largest = m.largest / clean.truth->spacing;
      ++runs;
      if (largest >= 0.05) ++above;
      if (largest > worst) {
        worst = largest;
        where = clean.name;
      }
    }
  std::printf("  clean clouds: largest move %.4f spacings%s%s, under 0.05: %s (%zu of %zu clouds above)\n",
              worst, where.empty() ? "" : " on ", where.c_str(), verdict(worst < 0.05), above, runs);
}

void print_thin_plate(const Plan& plan, const Variant& variant) {
  // The thickness is three spacings of the very cloud that is made: two rounds settle it.
  double thickness = 0.06, spacing = 0;
  Positions clean;
  for (int round = 0; round < 3; ++round) {
    if (round > 0) thickness = 3 * spacing;
    clean = clouds::sample(*clouds::make_plate(thickness), kPoints, 1);
    spacing = clouds::mean_spacing(clean);
  }
  for (const double sigma : {0.3, 0.5}) {
    Positions noisy = clean;
    clouds::add_noise(noisy, sigma * spacing, 2);
    const auto out = run_ours(noisy, variant, plan.threads).points;
    // Away from the plate's edges, where the sides are flat: mean height of each side's own points.
    double top = 0, bottom = 0, rms = 0;
    std::size_t tops = 0, bottoms = 0, crossed = 0;
    for (std::size_t i = 0; i < clean.size(); ++i) {
      const bool inner = std::abs(clean[i][0]) < 1 - 4 * spacing && std::abs(clean[i][1]) < 0.8 - 4 * spacing;
      if (!inner) continue;
      (clean[i][2] > 0 ? top : bottom) += out[i][2];
      ++(clean[i][2] > 0 ? tops : bottoms);
      rms += std::pow(out[i][2] - clean[i][2], 2);
      if (out[i][2] * clean[i][2] < 0) ++crossed;
    }
    const double ratio = (top / double(tops) - bottom / double(bottoms)) / thickness;
    std::printf(
        "  thin plate (thickness %.2f spacings, noise %.1f): mean thickness %.3f of the true one, within "
        "0.03: %s; "
        "%zu of %zu points on the wrong side; height error rms %.3f spacings\n",
        thickness / spacing, sigma, ratio, verdict(std::abs(ratio - 1) <= 0.03), crossed, tops + bottoms,
        std::sqrt(rms / double(tops + bottoms)) / spacing);
  }
}

void print_open_sheet(const Plan& plan, const Variant& variant) {
  const Positions clean = clouds::sample(*clouds::make_wavy_sheet(), kPoints, 1);
  const double spacing = clouds::mean_spacing(clean);
  for (const double sigma : {0.0, 0.3, 0.5, 1.0}) {
    Positions noisy = clean;
    clouds::add_noise(noisy, sigma * spacing, 2);
    const auto out = run_ours(noisy, variant, plan.threads).points;
    // Each side of [-1, 1]^2 on its own: how far its points (within half a spacing) went inwards on average.
    double worst = -1e300;
    for (int axis = 0; axis < 2; ++axis)
      for (const double side : {-1.0, 1.0}) {
        double inward = 0;
        std::size_t count = 0;
        for (std::size_t i = 0; i < clean.size(); ++i) {
          if (side * clean[i][axis] < 1 - spacing / 2) continue;
          inward += side * (clean[i][axis] - out[i][axis]);
          ++count;
        }
        worst = std::max(worst, inward / double(count) / spacing);
      }
    std::printf(
        "  open sheet (noise %.1f spacings): the rim's mean move inwards, worst side, %.3f spacings, at most "
        "0.3: %s\n",
        sigma, worst, verdict(worst <= 0.3));
  }
}

void print_repeatability(const Plan& plan, Cases& cases, const Variant& variant) {
  bool same = true;
  std::size_t runs = 0, above = 0;
  double worst = 0;
  std::string where;
  const std::size_t size = plan.sizes.front();
  for (const auto& noise : plan.noises) {
    if (noise.sigma == 0) continue;
    for (const auto& shape : plan.shapes) {
      const Case one = cases.make(shape, size, noise);
      const auto first = run_ours(one.noisy, variant, plan.threads).points;
      same = same && same_bytes(first, run_ours(one.noisy, variant, 1).points);
      const auto second = run_ours(first, variant, plan.threads).points;
      const double ratio = moves(first, second).rms / moves(one.noisy, first).rms;
      ++runs;
      if (ratio >= 0.2) ++above;
      if (ratio > worst) {
        worst = ratio;
        where = one.name;
      }
    }
  }
  std::printf("  two runs (%d threads and 1) give the same bytes: %s\n", plan.threads, verdict(same));
  std::printf(
      "  cleaning a cleaned cloud moves it (rms) by at most %.3f of the first pass (%s), under 0.2: %s (%zu "
      "of %zu "
      "clouds above)\n",
      worst, where.c_str(), verdict(worst < 0.2), above, runs);
}

}  // namespace rfsmooth::bench
