#include "pipeline/tiles/halo.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/quantile.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::pipeline::tiles {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr std::size_t kFewestOfPart = 64;  // points of a part
constexpr std::size_t kParts = 64;         // of a tile, as many points in each
constexpr std::size_t kPlacesOfPart = 16;  // at which patches are looked at
// Of the radii there, the quantile that is the part's: all but one, which may be a stray's. The median leaves
// too little around its sparse side.
constexpr double kWidePlaces = 1 - 1.0 / double(kPlacesOfPart);
constexpr std::size_t kGroup = 8;  // parts that are asked together first

/// Halves the places at the median of their widest axis, `times` over; calls `take` with each part.
template <class Take>
void halve(const Positions& points, Index* first, Index* last, std::size_t parts, const Take& take) {
  if (parts <= 1 || last - first < 2) return take(first, last);
  AlignedBox3d box;
  for (const Index* i = first; i != last; ++i) box.extend(points[*i]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  Index* const middle = first + (last - first) / 2;
  std::nth_element(first, middle, last, [&](Index a, Index b) {
    const double x = points[a][axis], y = points[b][axis];
    return x != y ? x < y : a < b;
  });
  halve(points, first, middle, parts / 2, take);
  halve(points, middle, last, parts / 2, take);
}

double radius_at(const rfs_mesh::SpatialIndex& index, const Vector3d& at, std::size_t m) {
  std::vector<rfs_mesh::Neighbor> near;
  index.nearest(at, int(std::min(m, index.points().size())), near);
  return std::sqrt(near.back().squared_distance);
}

}  // namespace

Positions distinct_places(const Positions& points) {
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), Index(0));
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    const Vector3d &p = points[a], &q = points[b];
    return p != q ? std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end()) : a < b;
  });
  std::vector<char> again(points.size(), 0);
  for (std::size_t k = 1; k < order.size(); ++k)
    again[order[k]] = char(points[order[k]] == points[order[k - 1]]);
  Positions once;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (again[i] == 0) once.push_back(points[i]);
  return once;
}

double typical_radius(const Positions& points, std::size_t m, const Context& context) {
  const rfs_mesh::SpatialIndex index(points, context);
  const std::size_t places = std::min(points.size(), rfs_mesh::kPlacesOfCloud);
  std::vector<double> radii(places);
  for_each_index(
      context, places,
      [&](std::size_t k) { radii[k] = radius_at(index, points[k * points.size() / places], m); }, 16);
  return rfsmooth::median(radii);
}

Halo::Halo(const Positions& points, std::size_t own, std::size_t m, double radii, const Context& context) {
  std::vector<Index> order(own);
  std::iota(order.begin(), order.end(), Index(0));
  std::vector<std::vector<Index>> places;
  halve(points, order.data(), order.data() + own, std::min(kParts, own / kFewestOfPart),
        [&](const Index* first, const Index* last) {
          if (first == last) return;
          parts_.emplace_back();
          for (const Index* i = first; i != last; ++i) parts_.back().box.extend(points[*i]);
          const auto count = std::size_t(last - first), some = std::min(count, kPlacesOfPart);
          places.emplace_back();
          for (std::size_t k = 0; k < some; ++k) places.back().push_back(first[k * count / some]);
        });
  const rfs_mesh::SpatialIndex index(points, context);
  for_each_index(
      context, parts_.size(),
      [&](std::size_t part) {
        std::vector<double> all;
        for (const Index i : places[part]) all.push_back(radius_at(index, points[i], m));
        parts_[part].reach = radii * quantile(all, kWidePlaces);
      },
      1);
  group();
}

void Halo::group() {
  groups_.clear();
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (p % kGroup == 0) groups_.emplace_back();
    const Vector3d reach = Vector3d::Constant(parts_[p].reach);
    groups_.back().extend(AlignedBox3d(parts_[p].box.min() - reach, parts_[p].box.max() + reach));
  }
}

void Halo::scale(double times) {
  for (Part& part : parts_) part.reach *= times;
  group();
}

bool Halo::holds(const Vector3d& p) const {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!groups_[g].contains(p)) continue;
    for (std::size_t k = g * kGroup; k < std::min(parts_.size(), (g + 1) * kGroup); ++k)
      if (parts_[k].box.squaredExteriorDistance(p) <= parts_[k].reach * parts_[k].reach) return true;
  }
  return false;
}

bool Halo::meets(const AlignedBox3d& box) const {
  return std::any_of(groups_.begin(), groups_.end(),
                     [&](const AlignedBox3d& g) { return g.intersects(box); });
}

}  // namespace rfsmooth::pipeline::tiles
