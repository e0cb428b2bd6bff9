#include "rfs_mesh/connect/part_sheets.h"

#include <algorithm>
#include <cmath>

#include "base/linear/symmetric_eigen.h"
#include "base/parallel.h"
#include "rfs_mesh/sheets/two_sheets.h"

namespace rfsmooth::rfs_mesh {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kFewest = 5;  ///< points that make a sheet: more than strays in a row

/// A point beyond the middle has the other sheet within 1.25 of its own distance d on the far side. What is
/// no farther than that from there is looked for: on a single sheet the nearest shadow is 2.25 d away.
constexpr double kMirror = 1.25;

/// A shadow and how high it lies over the point.
struct Height {
  double height;
  Index point;
  friend bool operator<(const Height& a, const Height& b) {
    return a.height != b.height ? a.height < b.height : a.point < b.point;
  }
};

enum class Place { on_its_sheet, off_its_sheet, between };

class Parter {
 public:
  Parter(const Positions& points, const SpatialIndex& shadows, const NeighborTable& near, double sigma,
         const SheetsOptions& options, const std::vector<LocalSurface>& surfaces)
      : points_(points),
        shadows_(shadows),
        near_(near),
        sigma_(sigma),
        options_(options),
        surfaces_(surfaces) {}

  /// For Place::off_its_sheet, `surface` gets its shadow and normal from the nearer sheet.
  Place place(Index i, LocalSurface& surface) {
    if (!doubtful(i) || !find_sheets(i)) return Place::on_its_sheet;
    const double low = height_of(0, upper_from_), high = height_of(upper_from_, heights_.size());
    if (high - low < std::max(options_.apart * scatter_, 2 * options_.far * sigma_))
      return Place::on_its_sheet;
    if (!surrounds(i, 0, upper_from_) || !surrounds(i, upper_from_, heights_.size()))
      return Place::on_its_sheet;
    if (low < 0 && high > 0 && std::min(-low, high) > options_.between * (high - low)) return Place::between;
    const bool lower = std::abs(low) < std::abs(high);
    const Vector3d shadow = points_[i] + (lower ? low : high) * axis_;
    if ((shadow - surfaces_[i].shadow).norm() <= options_.off * sigma_) return Place::on_its_sheet;
    surface.shadow = shadow;
    surface.normal = lower ? normal_of(0, upper_from_) : normal_of(upper_from_, heights_.size());
    return Place::off_its_sheet;
  }

 private:
  /// Whether i is worth a search, from the neighbours of its shadow alone: the shadow lies off the sheets of
  /// most of them, or the point far from those of some, and something lies on its other side.
  bool doubtful(Index i) {
    const Vector3d &p = points_[i], away = p - surfaces_[i].shadow;
    const double far = options_.far * sigma_, off = options_.off * sigma_, across = 0.5 * far * away.norm();
    std::size_t far_ones = 0, off_ones = 0, across_ones = 0;
    const auto row = near_[i];
    for (const Index j : row) {
      const Vector3d& n = surfaces_[j].normal;
      const double over_point = n.dot(surfaces_[j].shadow - p), rise = n.dot(away);
      far_ones += std::size_t(std::abs(over_point) > far);
      off_ones += std::size_t(std::abs(over_point + rise) > off);
      across_ones += std::size_t(over_point * rise > across);
    }
    if (2 * off_ones > row.size()) return true;
    if (3 * far_ones <= row.size()) return false;
    if (across_ones > 0) return true;
    return shadows_.any_within(p + kMirror * away, kMirror * away.norm());
  }

  /// The shadows around point i by height along the axis of their normals, split in two. False if the normals
  /// have no axis in common or the shadows are too few.
  bool find_sheets(Index i) {
    shadows_.nearest(points_[i], options_.looked_at, found_);
    Matrix3d spread = Matrix3d::Zero();
    heights_.clear();
    for (const Neighbor& q : found_) {
      if (q.index == i) continue;
      const Vector3d& n = surfaces_[q.index].normal;
      spread += n * n.transpose();
      heights_.push_back({0, q.index});
    }
    if (heights_.size() < 2 * kFewest) return false;
    const SymmetricEigen<3> eigen = symmetric_eigen(spread);
    if (eigen.values[2] < options_.parallel * double(heights_.size())) return false;
    axis_ = eigen.vectors.col(2);
    for (Height& h : heights_) h.height = axis_.dot(surfaces_[h.point].shadow - points_[i]);
    std::sort(heights_.begin(), heights_.end());
    ascending_.clear();
    for (const Height& h : heights_) ascending_.push_back(h.height);
    const SplitHeights split = split_heights(ascending_, kFewest);
    upper_from_ = split.lower;
    scatter_ = std::sqrt(split.variance);
    return true;
  }

  /// The median.
  double height_of(std::size_t begin, std::size_t end) const {
    return heights_[begin + (end - begin) / 2].height;
  }

  Vector3d normal_of(std::size_t begin, std::size_t end) const {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = begin; k < end; ++k) {
      const Vector3d& n = surfaces_[heights_[k].point].normal;
      sum += n.dot(axis_) < 0 ? Vector3d(-n) : n;
    }
    return sum.norm() > 0 ? Vector3d(sum.normalized()) : axis_;
  }

  /// Whether point i stands over the middle of the sheet and not beside it.
  bool surrounds(Index i, std::size_t begin, std::size_t end) const {
    Vector3d sum = Vector3d::Zero();
    double squares = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const Vector3d d = surfaces_[heights_[k].point].shadow - points_[i], flat = d - axis_.dot(d) * axis_;
      sum += flat;
      squares += flat.squaredNorm();
    }
    const double count = double(end - begin), most = options_.beside;
    return sum.squaredNorm() <= most * most * squares * count;
  }

  const Positions& points_;
  const SpatialIndex& shadows_;
  const NeighborTable& near_;
  double sigma_;
  const SheetsOptions& options_;
  const std::vector<LocalSurface>& surfaces_;

  std::vector<Neighbor> found_;
  std::vector<Height> heights_;    // ascending
  std::vector<double> ascending_;  // the same without their points
  std::size_t upper_from_ = 0;     // where those of the upper sheet begin
  double scatter_ = 0;             // root mean square within the sheets
  Vector3d axis_ = Vector3d::UnitZ();
};

}  // namespace

std::vector<char> part_sheets(const Positions& points, const SpatialIndex& shadows, const NeighborTable& near,
                              double sigma, const SheetsOptions& options, std::vector<LocalSurface>& surfaces,
                              const Context& context) {
  struct Finding {
    Index point;
    bool between;
    LocalSurface surface;
  };
  constexpr std::size_t kGrain = 512;
  std::vector<std::vector<Finding>> found((points.size() + kGrain - 1) / kGrain);
  for_blocks(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Parter parter(points, shadows, near, sigma, options, surfaces);
    for (std::size_t i = begin; i < end; ++i) {
      LocalSurface surface = surfaces[i];
      const Place place = parter.place(Index(i), surface);
      if (place != Place::on_its_sheet)
        found[begin / kGrain].push_back({Index(i), place == Place::between, surface});
    }
  });
  std::vector<char> between;
  for (const auto& block : found)
    for (const Finding& f : block) {
      if (!f.between) {
        surfaces[f.point] = f.surface;
        continue;
      }
      between.resize(points.size(), 0);
      between[f.point] = 1;
    }
  return between;
}

}  // namespace rfsmooth::rfs_mesh
