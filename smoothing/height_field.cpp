#include "rfsmooth/smoothing/height_field.h"

#include <algorithm>
#include <utility>

#include "rfsmooth/rfs_mesh/collect.h"
#include "rfsmooth/rfs_mesh/parallel.h"
#include "rfsmooth/rfs_mesh/sides.h"
#include "rfsmooth/smoothing/plane_normal.h"

namespace rfsmooth::smoothing {

namespace {

constexpr std::size_t kPlane = 24;  // neighbours of the plane that gives the normal
constexpr std::size_t kLinked = 8;  // neighbours with which a normal agrees on a side; 6 leave islands
constexpr double kSameSheet = 0.5;  // cosine of 60 degrees

}  // namespace

double same_sheet(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double cosine = a.dot(b);
  return cosine < kSameSheet ? 0 : cosine * cosine;
}

HeightField::HeightField(Positions guide, const Positions& data, const Context& context)
    : HeightField(std::move(guide), {}, data, context) {}

HeightField::HeightField(Positions guide, rfs_mesh::NeighborTable near, const Positions& data,
                         const Context& context)
    : guide_(std::move(guide)), index_(guide_, context), near_(std::move(near)) {
  if (near_.k == 0) near_ = index_.nearest(kNear, context);
  normals_.resize(size());
  heights_.resize(size());
  local_.resize(size());
  for_each_index(context, size(), [&](std::size_t i) {
    const auto row = near_[i];
    normals_[i] = plane_normal(guide_, i, {row.begin(), row.begin() + std::min(row.size(), kPlane)});
    if (!normals_[i].allFinite()) normals_[i] = Eigen::Vector3d::UnitZ();
  });
  orient(context);
  for_each_index(context, size(), [&](std::size_t i) {
    heights_[i] = normals_[i].dot(data[i] - guide_[i]);
    local_[i] = {normals_[i].cast<float>(), float(heights_[i])};
  });
}

void HeightField::orient(const Context& context) {
  const auto linked = [&](std::size_t i) {
    const auto near = near_[i];
    return std::make_pair(near.begin(), near.begin() + std::min(near.size(), kLinked));
  };
  const auto links = rfs_mesh::collect<rfs_mesh::SideLink>(context, size(), [&](std::size_t i, auto&& emit) {
    const auto [first, last] = linked(i);
    for (auto j = first; j != last; ++j) {
      const auto [back, end] = linked(*j);
      if (*j < i && std::find(back, end, Index(i)) != end) continue;  // the other has this link
      emit({Index(i), *j, float(normals_[i].dot(normals_[*j])), 1});
    }
  });
  const rfs_mesh::Regions regions = rfs_mesh::grow_regions(size(), links, {}, context);
  for_each_index(context, size(), [&](std::size_t i) {
    if (regions.turned[i] != 0) normals_[i] = -normals_[i];
  });
}

std::vector<double> HeightField::local_mean(const std::vector<double>& values, const Context& context) const {
  std::vector<double> mean(values.size());
  for_each_index(context, size(), [&](std::size_t i) {
    const auto row = near_[i];
    const double square =
        row.size() == 0 ? 0 : 1.05 * (guide_[row[row.size() - 1]] - guide_[i]).squaredNorm();
    double sum = values[i], weights = 1;
    for (const Index j : row) {
      if (same_sheet(normals_[i], normals_[j]) == 0) continue;
      const double w = square > 0 ? 1 - (guide_[j] - guide_[i]).squaredNorm() / square : 1;
      sum += w * values[j];
      weights += w;
    }
    mean[i] = sum / weights;
  });
  return mean;
}

}  // namespace rfsmooth::smoothing
