/// How far the points of a cloud moved, as a picture of bars: SVG, which needs no script.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace rfsmooth::pipeline {

/// The colours of displacements from 0 to `Histogram::top`, at even distances: five anchors of matplotlib's
/// viridis, as `rfsmooth render` has them. Between them straight lines.
inline constexpr std::array<std::string_view, 5> kScale = {"#440154", "#3a528b", "#21918c", "#5ec962",
                                                           "#fde724"};

/// How far the points of a page moved.
struct Histogram {
  std::size_t still = 0;            ///< how many did not move at all
  std::vector<std::size_t> counts;  ///< of the others: bars of equal width from 0 to `top`
  std::size_t beyond = 0;           ///< and those that moved farther
  double top = 0;                   ///< all but 1 % moved at most so far, world units; 0 if none moved
};

/// Of the displacements that are finite. O(n).
Histogram histogram_of(const std::vector<double>& displacements);

/// The bars as an SVG element. Each has its count as attribute `data-count`, and says what it stands for.
std::string svg_of(const Histogram& histogram);

}  // namespace rfsmooth::pipeline
