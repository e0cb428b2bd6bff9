#include "tests/bench/scans/flats.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <Eigen/Geometry>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::bench {
namespace {

using Cell = std::pair<int, int>;

constexpr int kSeeds = 400;              // places where a plane is looked for
constexpr int kAround = 600;             // nearest points of a seed ...
constexpr int kFarAround = 2400;         // ... and where these lie on one step of the depth
constexpr double kLeastDeviation = 0.2;  // spacings: calm and loud places of one plane are one plane
constexpr double kWhole = 0.95;          // filled cells of a patch and its border: less than a row may lack
constexpr int kDraws =
    150;  // with half of the points on the plane one draw in eight is, so all fail with 2e-9
constexpr double kCell = 3;         // side of a cell in spacings: nine points
constexpr int kPatch = 6;           // side of a patch in cells: about three hundred points
constexpr int kBorder = 3;          // cells between a patch and the border of its plane
constexpr double kReach = 3;        // inliers, in standard deviations
constexpr double kTails = 10;       // loud points that still belong to the plane, in standard deviations
constexpr double kMostLoud = 0.1;   // share of points beyond kReach; more is another thing on the plane
constexpr double kLeastSine = 0.4;  // between planes that make a crease: 24 degrees
constexpr double kFromCrease = 4, kSideDepth = 30;  // where the sides of a crease are fitted, in spacings
constexpr double kStretch = 32;                     // length of a crease, in spacings
constexpr double kCreaseReach = 3;                  // points of a crease, in spacings
constexpr std::size_t kLeastSide = 150, kLeastCrease = 20;

/// A plane with the cells that it fills.
struct Grown {
  Plane plane;
  double deviation = 0, spacing = 0;
  std::array<Eigen::Vector3d, 2> axes;
  std::set<Cell> cells;     // one connected piece
  std::vector<Index> rows;  // inliers there

  Cell cell(const Eigen::Vector3d& p) const {
    const double side = kCell * spacing;
    return {int(std::floor(axes[0].dot(p - plane.point) / side)),
            int(std::floor(axes[1].dot(p - plane.point) / side))};
  }
};

std::set<Cell> connected(const std::set<Cell>& cells, const Cell& from) {
  std::set<Cell> piece;
  if (cells.count(from) == 0) return piece;
  std::vector<Cell> open = {from};
  piece.insert(from);
  while (!open.empty()) {
    const auto [x, y] = open.back();
    open.pop_back();
    for (const Cell& next : {Cell{x - 1, y}, Cell{x + 1, y}, Cell{x, y - 1}, Cell{x, y + 1}})
      if (cells.count(next) != 0 && piece.insert(next).second) open.push_back(next);
  }
  return piece;
}

/// Finds planes one after the other; a point belongs to one at most.
class Finder {
 public:
  Finder(const Positions& points, std::uint64_t seed)
      : points_(points), index_(points, {}), random_(seed), owner_(points.size(), -1) {}

  std::vector<Grown> planes() {
    std::vector<Grown> found;
    for (int s = 0; s < kSeeds; ++s) {
      const auto at = Index(random_.uniform() * double(points_.size()));
      if (owner_[at] >= 0) continue;
      Grown grown = grow(at);
      // Room for one patch with its border, at the least.
      if (grown.cells.size() < std::size_t((kPatch + 2 * kBorder) * (kPatch + 2 * kBorder))) continue;
      for (const Index i : grown.rows) owner_[i] = int(found.size());
      found.push_back(std::move(grown));
    }
    return found;
  }

  const std::vector<int>& owner() const { return owner_; }

 private:
  Grown grow(Index at) {
    Grown grown = start(at, kAround);
    if (grown.deviation == 0) grown = start(at, kFarAround);
    if (grown.deviation == 0) return {};  // one step, or the same place many times
    grown.deviation = std::max(grown.deviation, kLeastDeviation * grown.spacing);
    for (int pass = 0; pass < 2; ++pass) {
      fill(at, grown);
      if (grown.rows.size() < kAround / 2) return {};
      grown.plane = fit_plane_trimmed(points_, grown.rows);
    }
    fill(at, grown);
    return grown;
  }

  /// The plane of the nearest points; deviation 0 if they lie on one step (within a thousandth of a spacing)
  /// or are as thick as they are wide.
  Grown start(Index at, int around) {
    constexpr double kPi = 3.14159265358979;
    index_.nearest(points_[at], around, near_);
    std::vector<Index> rows;
    for (const auto& n : near_) rows.push_back(n.index);
    Grown grown;
    grown.plane = draw_plane(points_, rows, kDraws, random_);
    std::vector<Index> inliers = rows;
    within(grown.plane, kReach * robust_deviation(grown.plane, points_, rows), inliers);
    grown.plane = fit_plane_trimmed(points_, inliers);
    const double radius = std::sqrt(near_.back().squared_distance);
    grown.spacing = radius * std::sqrt(kPi / around);
    grown.deviation = robust_deviation(grown.plane, points_, rows);
    if (grown.deviation <= 1e-3 * grown.spacing || grown.deviation > radius / 6) grown.deviation = 0;
    return grown;
  }

  /// Leaves the rows within reach of the plane.
  void within(const Plane& plane, double reach, std::vector<Index>& rows) const {
    rows.erase(std::remove_if(rows.begin(), rows.end(),
                              [&](Index i) { return std::abs(plane.height(points_[i])) > reach; }),
               rows.end());
  }

  /// The cells around the seed that have points of nobody else within reach, and these points.
  void fill(Index at, Grown& grown) const {
    grown.axes = grown.plane.axes();
    std::vector<Index> inliers;
    std::set<Cell> cells;
    for (Index i = 0; i < points_.size(); ++i) {
      if (owner_[i] >= 0 || std::abs(grown.plane.height(points_[i])) > kReach * grown.deviation) continue;
      inliers.push_back(i);
      cells.insert(grown.cell(points_[i]));
    }
    grown.cells = connected(cells, grown.cell(points_[at]));
    grown.rows.clear();
    for (const Index i : inliers)
      if (grown.cells.count(grown.cell(points_[i])) != 0) grown.rows.push_back(i);
  }

  const Positions& points_;
  rfs_mesh::SpatialIndex index_;
  clouds::Random random_;
  std::vector<int> owner_;
  std::vector<rfs_mesh::Neighbor> near_;
};

/// All cells from (x - border) to (x + kPatch + border), and the same along y.
template <class Visit>
void for_patch(const Cell& corner, int border, Visit&& visit) {
  for (int x = corner.first - border; x < corner.first + kPatch + border; ++x)
    for (int y = corner.second - border; y < corner.second + kPatch + border; ++y) visit(Cell{x, y});
}

/// Which patch a cell is of. Patches have filled cells around them, kBorder wide, and no cell in common; from
/// low to high each is taken where there is room.
std::map<Cell, std::size_t> inner_patches(const std::set<Cell>& cells, std::size_t& count) {
  std::map<Cell, std::size_t> patch_of;
  count = 0;
  for (const Cell& corner : cells) {
    std::size_t filled = 0, taken = 0;
    for_patch(corner, kBorder, [&](const Cell& c) { filled += cells.count(c); });
    for_patch(corner, 0, [&](const Cell& c) { taken += patch_of.count(c); });
    if (taken > 0 || double(filled) < kWhole * std::pow(kPatch + 2 * kBorder, 2)) continue;
    for_patch(corner, 0, [&](const Cell& c) { patch_of[c] = count; });
    ++count;
  }
  return patch_of;
}

/// The patch of a column of points, if it is one: of one thing, and flat.
std::optional<Patch> make_patch(const Positions& points, const Grown& grown, std::vector<Index> column) {
  if (column.size() < kLeastSide) return std::nullopt;
  std::size_t loud = 0;
  for (const Index i : column) loud += std::abs(grown.plane.height(points[i])) > kReach * grown.deviation;
  if (double(loud) > kMostLoud * double(column.size())) return std::nullopt;
  Patch patch;
  patch.plane = fit_plane_trimmed(points, column);
  if (!is_flat(patch.plane, points, column)) return std::nullopt;
  patch.spacing = kPatch * kCell * grown.spacing / std::sqrt(double(column.size()));
  patch.rows = std::move(column);
  return patch;
}

void add_patches(const Positions& points, const Grown& grown, std::vector<Patch>& patches) {
  std::size_t count = 0;
  const auto patch_of = inner_patches(grown.cells, count);
  std::vector<std::vector<Index>> columns(count);
  for (Index i = 0; i < points.size(); ++i) {
    if (std::abs(grown.plane.height(points[i])) > kTails * grown.deviation) continue;
    const auto at = patch_of.find(grown.cell(points[i]));
    if (at != patch_of.end()) columns[at->second].push_back(i);
  }
  for (auto& column : columns)
    if (auto patch = make_patch(points, grown, std::move(column))) patches.push_back(std::move(*patch));
}

/// A line, and what is near it.
struct Line {
  Eigen::Vector3d point, direction;
  double along(const Eigen::Vector3d& p) const { return direction.dot(p - point); }
  double distance(const Eigen::Vector3d& p) const { return (p - point - along(p) * direction).norm(); }
};

/// Where two planes meet; the point of the line nearest to `near`. The planes are not parallel.
Line meet(const Plane& a, const Plane& b, const Eigen::Vector3d& near) {
  const Eigen::Vector3d direction = a.normal.cross(b.normal);
  Eigen::Matrix3d rows;
  rows << a.normal.transpose(), b.normal.transpose(), direction.transpose();
  const Eigen::Vector3d right(a.normal.dot(a.point), b.normal.dot(b.point), direction.dot(near));
  return {rows.inverse() * right, direction.normalized()};
}

/// The rows of one side: away from the line, and some of them next to it.
std::vector<Index> side_of(const Positions& points, const std::vector<Index>& rows, const Line& line,
                           double spacing) {
  std::vector<Index> side;
  std::size_t next = 0;
  for (const Index i : rows) {
    const double d = line.distance(points[i]) / spacing;
    if (d < kFromCrease || d > kSideDepth) continue;
    side.push_back(i);
    next += d < 2 * kFromCrease;
  }
  if (side.size() < kLeastSide || next < kLeastCrease) side.clear();
  return side;
}

/// Whether the raw points follow the two planes up to the line, as they follow them beside it: not a rounded
/// edge.
bool is_sharp(const Crease& crease, const Positions& points, const std::vector<Index>& one,
              const std::vector<Index>& other) {
  constexpr double kMost = 1.2;
  double squares = 0;
  for (const Index i : crease.rows) squares += std::pow(crease.distance(points[i]), 2);
  const double beside =
      std::max(robust_deviation(crease.one, points, one), robust_deviation(crease.other, points, other));
  return std::sqrt(squares / double(crease.rows.size())) <= kMost * beside;
}

/// The stretch of a crease, if both planes come up to the line there. `near`: all rows about it.
void add_crease(const Positions& points, const std::vector<int>& owner, const std::vector<Index>& near,
                std::pair<int, int> planes, const Line& line, double spacing, std::vector<Crease>& creases) {
  std::array<std::vector<Index>, 2> rows;
  for (const Index i : near) {
    if (owner[i] == planes.first) rows[0].push_back(i);
    if (owner[i] == planes.second) rows[1].push_back(i);
  }
  const auto one = side_of(points, rows[0], line, spacing), other = side_of(points, rows[1], line, spacing);
  if (one.empty() || other.empty()) return;
  Crease crease;
  crease.one = fit_plane_trimmed(points, one);
  crease.other = fit_plane_trimmed(points, other);
  if (crease.one.normal.cross(crease.other.normal).norm() < kLeastSine) return;
  if (!is_flat(crease.one, points, one) || !is_flat(crease.other, points, other)) return;
  crease.spacing = spacing;
  const Line here = meet(crease.one, crease.other, points[one.front()]);
  for (const Index i : near)
    if (here.distance(points[i]) <= kCreaseReach * spacing) crease.rows.push_back(i);
  if (crease.rows.size() >= kLeastCrease && is_sharp(crease, points, one, other))
    creases.push_back(std::move(crease));
}

void add_creases(const Positions& points, const std::vector<int>& owner, const std::vector<Grown>& planes,
                 int a, int b, std::vector<Crease>& creases) {
  const Grown &one = planes[std::size_t(a)], &other = planes[std::size_t(b)];
  if (one.plane.normal.cross(other.plane.normal).norm() < kLeastSine) return;
  const double spacing = std::max(one.spacing, other.spacing);
  const Line line = meet(one.plane, other.plane, one.plane.point);
  std::map<int, std::vector<Index>> stretches;
  for (Index i = 0; i < points.size(); ++i)
    if (line.distance(points[i]) <= kSideDepth * spacing)
      stretches[int(std::floor(line.along(points[i]) / (kStretch * spacing)))].push_back(i);
  for (const auto& [stretch, rows] : stretches)
    add_crease(points, owner, rows, {a, b}, line, spacing, creases);
}

}  // namespace

Flats find_flats(const Positions& points, std::uint64_t seed) {
  Flats flats;
  if (points.size() < kAround) return flats;
  Finder finder(points, seed);
  const std::vector<Grown> planes = finder.planes();
  std::vector<char> real;  // with a flat inside
  for (const Grown& grown : planes) {
    const std::size_t before = flats.patches.size();
    add_patches(points, grown, flats.patches);
    real.push_back(flats.patches.size() > before);
    flats.planes += std::size_t(real.back());
  }
  for (int a = 0; a < int(planes.size()); ++a)
    for (int b = 0; b < a; ++b)
      if (real[std::size_t(a)] != 0 && real[std::size_t(b)] != 0)
        add_creases(points, finder.owner(), planes, a, b, flats.creases);
  return flats;
}

}  // namespace rfsmooth::bench
