#include "pipeline/page/histogram.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/quantile.h"

namespace rfsmooth::pipeline {

namespace {

constexpr std::size_t kBars = 40;
// In units of the picture, which grows with the page.
constexpr double kWidth = 640, kHeight = 260, kBase = 225, kBar = kWidth / (kBars + 4);

/// One bar: `place` counts bars from the left, a gap apart from the neighbours if it is not a whole number.
/// \param most the count of the highest
std::string bar(double place, std::size_t count, std::size_t most, std::string_view kind,
                std::string_view color, const std::string& says) {
  const double height = count == 0 ? 0 : std::max(1.0, double(count) / double(most) * (kBase - 10));
  return fmt::format(
      "<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\" "
      "data-count=\"{}\"><title>{}: {}</title></rect>\n",
      kind, place * kBar, kBase - height, kBar - 1, height, color, count, says, count);
}

std::string label(double place, std::string_view anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.2f}\" y=\"{}\" text-anchor=\"{}\">{}</text>\n", place * kBar, kBase + 28,
                     anchor, text);
}

/// The colour `share` of the way along the scale.
std::string color_at(double share) {
  const double at = share * double(kScale.size() - 1);
  const auto k = std::min(kScale.size() - 2, std::size_t(at));
  std::string color = "#";
  for (std::size_t digit = 1; digit < 7; digit += 2) {
    const auto level = [&](std::size_t anchor) {
      return double(std::stoi(std::string(kScale[anchor].substr(digit, 2)), nullptr, 16));
    };
    color += fmt::format("{:02x}", std::lround(level(k) + (at - double(k)) * (level(k + 1) - level(k))));
  }
  return color;
}

}  // namespace

Histogram histogram_of(const std::vector<double>& displacements) {
  Histogram histogram;
  std::vector<double> moved;
  for (const double d : displacements) {
    if (d > 0) moved.push_back(d);
    if (d == 0) ++histogram.still;
  }
  histogram.counts.assign(kBars, 0);
  if (moved.empty()) return histogram;
  histogram.top = quantile(moved, 0.99);
  for (const double d : moved) {
    if (d > histogram.top)
      ++histogram.beyond;
    else
      ++histogram.counts[std::min(kBars - 1, std::size_t(d / histogram.top * double(kBars)))];
  }
  return histogram;
}

std::string svg_of(const Histogram& histogram) {
  std::size_t most = std::max<std::size_t>({1, histogram.still, histogram.beyond});
  for (const std::size_t count : histogram.counts) most = std::max(most, count);
  std::string svg = fmt::format(
      "<svg id=\"histogram\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"how far the points moved\">\n",
      kWidth, kHeight);
  svg += bar(0, histogram.still, most, "still", "#9a9a9a", "did not move");
  for (std::size_t k = 0; k < histogram.counts.size() && histogram.top > 0; ++k) {
    const double low = histogram.top * double(k) / kBars, high = histogram.top * double(k + 1) / kBars;
    svg += bar(1.5 + double(k), histogram.counts[k], most, "moved", color_at((double(k) + 0.5) / kBars),
               fmt::format("{:.3g} to {:.3g}", low, high));
  }
  if (histogram.top > 0) {
    svg += bar(2 + kBars, histogram.beyond, most, "beyond", color_at(1),
               fmt::format("more than {:.3g}", histogram.top));
    svg += label(1.5, "start", "0") +
           label(1.5 + kBars / 2.0, "middle", fmt::format("{:.3g}", histogram.top / 2)) +
           label(1.5 + kBars, "end", fmt::format("{:.3g}", histogram.top));
  }
  return svg + "</svg>\n";
}

}  // namespace rfsmooth::pipeline
