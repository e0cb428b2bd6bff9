/// A page to look at: one HTML file that shows a cloud before and after side by side, and what was done to it
/// in figures. It holds everything that it needs and loads nothing: no server, no network.
///
///     write_bytes(make_page(contents, context), "r.html", ...);
///
/// What the page holds of a point is in blocks.h, which points it holds in shown.h, what it does with them in
/// viewer/*.js. Without WebGL, or without scripts, the figures, the histogram and the command remain.
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>

#include "pipeline/io/point_fields.h"

namespace rfsmooth::pipeline {

/// A cloud of n rows, as its file has it.
struct PageSide {
  std::string name;             ///< of the file
  std::vector<double> xyz;      ///< n x 3, world units; rows that are not finite are not drawn
  std::vector<double> normals;  ///< n x 3, or empty
};

/// What a page shows. Strings may hold anything: they are escaped.
struct PageContents {
  PageSide before, after;                    ///< row i of both is the same point
  std::vector<io::Rgb> colors;               ///< n: its own colours, or empty
  std::vector<char> outlier;                 ///< n: 1 = no surface near, or empty
  std::optional<Eigen::Vector3d> viewpoint;  ///< where the scanner stood: the page first looks from there
  std::vector<std::pair<std::string, std::string>> figures;  ///< what and how much, beside those of the page
  std::string command;                                       ///< which makes the page again
  std::size_t points = 300000;  ///< the most that are shown; the figures and the histogram are of all
};

/// A side as the file of that name has it.
PageSide page_side(const std::filesystem::path& path, const io::Cloud& cloud, const Context& context);

/// Contents with all that the file before says: its side, colours and viewpoint.
PageContents page_before(const std::filesystem::path& path, const io::Cloud& cloud, const Context& context);

/// \throw Failure (usage) if the numbers of points differ.
void need_same_size(const std::string& before_name, std::size_t before, const std::string& after_name,
                    std::size_t after);

/// For `PageContents::points`.
inline constexpr std::size_t kAllPoints = std::numeric_limits<std::size_t>::max();

/// The bytes of the HTML file, in UTF-8: the same for the same contents and any number of threads. \throw
/// Failure: usage (two clouds of different size), no_usable_points (no row is finite before). O(n log n),
/// about 100 bytes a point beside the contents.
std::string make_page(const PageContents& contents, const Context& context);

}  // namespace rfsmooth::pipeline
