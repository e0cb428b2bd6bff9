#include "pipeline/page/page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/fail.h"
#include "base/parallel.h"
#include "pipeline/page/assets.h"
#include "pipeline/page/blocks.h"
#include "pipeline/page/histogram.h"
#include "pipeline/page/shown.h"
#include "pipeline/page/text.h"
#include "pipeline/viewpoint.h"

namespace rfsmooth::pipeline {

using Eigen::Vector3d;
using nlohmann::ordered_json;

namespace {

/// Middle of the box around the rows, from which float32 is fine enough for a picture.
Vector3d middle_of(const std::vector<double>& xyz, const std::vector<std::size_t>& rows) {
  Eigen::AlignedBox3d box;
  for (const std::size_t row : rows) box.extend(Vector3d(&xyz[3 * row]));
  return box.min() + box.sizes() / 2;
}

std::vector<Eigen::Vector3f> normals_shown(const std::vector<double>& normals,
                                           const std::vector<std::size_t>& rows) {
  std::vector<Eigen::Vector3f> shown;
  for (std::size_t i = 0; i < rows.size() && !normals.empty(); ++i)
    shown.emplace_back(Vector3d(&normals[3 * rows[i]]).cast<float>());
  return shown;
}

ShownPoints points_shown(const PageContents& contents, const std::vector<RowKind>& kinds,
                         const std::vector<std::size_t>& rows, const Vector3d& centre) {
  ShownPoints shown;
  for (const std::size_t row : rows) {
    shown.before.emplace_back(Vector3d(&contents.before.xyz[3 * row]) - centre);
    shown.after.emplace_back(kinds[row] == RowKind::removed
                                 ? shown.before.back()
                                 : Vector3d(Vector3d(&contents.after.xyz[3 * row]) - centre));
    shown.kinds.push_back(kinds[row]);
    if (!contents.colors.empty()) shown.colors.push_back(contents.colors[row]);
  }
  shown.normals_before = normals_shown(contents.before.normals, rows);
  shown.normals_after = normals_shown(contents.after.normals, rows);
  return shown;
}

/// From where the page first looks, as directions: from the scanner's place, where it is known and beside the
/// cloud, upright as cameras have it (y down); else at the broad side, a little from above.
struct FirstLook {
  Vector3d toward, up;  ///< from the cloud to the eye; up in the picture
};

FirstLook first_look(const Positions& points, const std::optional<Vector3d>& viewpoint) {
  if (viewpoint) {
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& p : points) mean += (*viewpoint - p).stableNormalized() / double(points.size());
    // A cloud all around it is not seen from there.
    if (mean.norm() > 0.5)
      return {mean.normalized(), std::abs(mean[2]) > 0.7 * mean.norm() ? Vector3d(-Vector3d::UnitY())
                                                                       : Vector3d(Vector3d::UnitZ())};
  }
  const Vector3d toward = -broadside(points);
  return {toward, std::abs(toward[2]) > 0.98 ? Vector3d::UnitY() : Vector3d::UnitZ()};
}

ordered_json json_of(const Vector3d& v) {
  return {v[0], v[1], v[2]};
}

/// What the page's script must know beside the planes; see viewer/decode.js.
ordered_json about_of(const ShownPoints& shown, const PackedPoints& packed, const Vector3d& centre,
                      const FirstLook& look, double top) {
  double radius = 0;
  for (const Vector3d& p : shown.before) radius = std::max(radius, p.norm());
  for (const Vector3d& p : shown.after) radius = std::max(radius, p.norm());
  auto blocks = ordered_json::array();
  for (const PageBlock& b : packed.blocks)
    blocks.push_back({{"count", b.count},
                      {"kind", int(b.kind)},
                      {"origin", json_of(b.origin)},
                      {"step", b.step},
                      {"unit", b.unit},
                      {"reach", b.reach}});
  return {{"shown", shown.before.size()},
          {"centre", json_of(centre)},
          {"radius", radius},
          {"toward", json_of(look.toward)},
          {"up", json_of(look.up)},
          {"top", top},
          {"scale", kScale},
          {"colors", !shown.colors.empty()},
          {"normals", {!shown.normals_before.empty(), !shown.normals_after.empty()}},
          {"blocks", blocks}};
}

/// "1.23" and the like, of what is a length.
std::string length_text(double value) {
  return fmt::format("{:.4g}", value);
}

/// The figures of the page itself, and those it was given, as rows of a table.
std::string rows_of_figures(const PageContents& contents, const std::vector<double>& moved,
                            std::size_t removed, std::size_t shown) {
  std::vector<double> finite;
  std::size_t still = 0;
  for (const double d : moved) {
    if (std::isfinite(d)) finite.push_back(d);
    still += std::size_t(d == 0);
  }
  std::vector<std::pair<std::string, std::string>> figures = {{"points", std::to_string(moved.size())}};
  if (finite.size() + removed < moved.size())
    figures.emplace_back("not finite", std::to_string(moved.size() - finite.size() - removed));
  if (removed > 0) figures.emplace_back("removed", std::to_string(removed));
  figures.emplace_back("moved", std::to_string(finite.size() - still));
  if (!finite.empty()) {
    double squares = 0;
    for (const double d : finite) squares += d * d;
    std::sort(finite.begin(), finite.end());
    figures.emplace_back("largest move", length_text(finite.back()));
    figures.emplace_back("rms of moves", length_text(std::sqrt(squares / double(finite.size()))));
    figures.emplace_back("median move", length_text(finite[finite.size() / 2]));
  }
  figures.insert(figures.end(), contents.figures.begin(), contents.figures.end());
  figures.emplace_back("points in this page", std::to_string(shown));
  std::string rows;
  for (const auto& [name, value] : figures)
    rows += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", escaped(name), escaped(value));
  return rows;
}

}  // namespace

PageSide page_side(const std::filesystem::path& path, const io::Cloud& cloud, const Context& context) {
  return {path.filename().string(), io::positions(cloud, context), io::normals_of(cloud, context)};
}

PageContents page_before(const std::filesystem::path& path, const io::Cloud& cloud, const Context& context) {
  PageContents contents;
  contents.before = page_side(path, cloud, context);
  contents.colors = io::colors_of(cloud, context);
  contents.viewpoint = recorded_viewpoint(cloud, contents.before.xyz.data(), context);
  return contents;
}

void need_same_size(const std::string& before_name, std::size_t before, const std::string& after_name,
                    std::size_t after) {
  if (before != after)
    fail(ErrorCode::usage, "{} has {} and {} has {}: a page needs the same points in the same order",
         before_name, counted(before, "point"), after_name, after);
}

std::string make_page(const PageContents& contents, const Context& context) {
  need_same_size(contents.before.name, contents.before.xyz.size() / 3, contents.after.name,
                 contents.after.xyz.size() / 3);
  std::string page;
  in_arena(context, [&] {
    const std::vector<double> moved = displacements(contents.before.xyz, contents.after.xyz);
    const std::vector<RowKind> kinds =
        kinds_of_rows(contents.before.xyz, contents.after.xyz, contents.outlier);
    const std::vector<std::size_t> rows =
        shown_rows(contents.before.xyz, moved, kinds, contents.points, context);
    const Vector3d centre = middle_of(contents.before.xyz, rows);
    const ShownPoints shown = points_shown(contents, kinds, rows, centre);
    const PackedPoints packed = pack_points(shown, context);
    const Histogram histogram = histogram_of(moved);
    std::optional<Vector3d> viewpoint;
    if (contents.viewpoint) viewpoint = *contents.viewpoint - centre;
    const auto removed = std::size_t(std::count(kinds.begin(), kinds.end(), RowKind::removed));
    page =
        filled(kPageHtml,
               {{"style", std::string(kPageCss)},
                {"style-hash", base64(bytes_of_hex(kPageCssHash))},
                {"script", std::string(kPageScript)},
                {"script-hash", base64(bytes_of_hex(kPageScriptHash))},
                {"before", escaped(contents.before.name)},
                {"after", escaped(contents.after.name)},
                {"command", escaped(contents.command)},
                {"figures", rows_of_figures(contents, moved, removed, rows.size())},
                {"histogram", svg_of(histogram)},
                {"about",
                 about_of(shown, packed, centre, first_look(shown.before, viewpoint), histogram.top).dump()},
                {"points", base64(gzipped(packed.bytes))}});
  });
  return page;
}

}  // namespace rfsmooth::pipeline
