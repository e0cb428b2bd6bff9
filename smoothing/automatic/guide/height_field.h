/// A noisy cloud seen as heights over a smooth guide.
///
///     x_i = g_i + z_i n_i + (a tangential rest that is left alone)
///
/// The guide g lies near the surface, its neighbourhoods and normals are calm; what is left to estimate is
/// one number a point. The normals (guide_normals.h) point to one side along the guide: the two sheets of a
/// thin wall have opposite normals however near they are to each other. Which of the two sides is arbitrary.
/// Const functions are thread safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/statistics.h>

#include "base/raw_array.h"
#include "rfs_mesh/levels.h"
#include "rfs_mesh/search/neighbors.h"
#include "smoothing/automatic/rows/near_rows.h"

namespace rfsmooth::smoothing {

/// Heights of the data over the guide.
class HeightField {
 public:
  static constexpr int kNear = int(NearRows::kMost);  ///< neighbours over which values are averaged

  /// A point's normal and height, together for those who read many at random.
  struct Local {
    Eigen::Vector3f normal;
    float height;
  };

  /// \param guide n x 3, near the surface; n >= 2.
  /// \param tree of the guide points, here or at places near these.
  /// \param near n x kNear (n - 1 where that is less): the nearest of every guide point.
  /// \param data n x 3, the noisy points of the same indices.
  /// \param noise whether points lie along lines, and how many are a piece of the surface.
  /// \throw std::invalid_argument if the three differ in n.
  /// O(n log n), parallel, the same bits for any number of threads.
  HeightField(Positions guide, rfs_mesh::KdTree tree, const rfs_mesh::NeighborTable& near,
              const Positions& data, const NoiseModel& noise, const Context& context);
  HeightField(const HeightField&) = delete;
  HeightField& operator=(const HeightField&) = delete;

  std::size_t size() const { return guide_.size(); }
  bool on_lines() const { return on_lines_; }  ///< whether the nearest points lie along lines
  const Positions& guide() const { return guide_; }
  /// Unit; from single precision, like the height.
  Eigen::Vector3d normal(std::size_t i) const { return local_[i].normal.cast<double>(); }
  double height(std::size_t i) const { return double(local_[i].height); }  ///< z, world units
  const rfs_mesh::SpatialIndex& index() const { return *index_; }  ///< over the guide; ready for searches

  const std::vector<Local>& local() const { return local_; }  ///< n: normals and heights
  const NearRows& neighbors() const { return near_; }         ///< n x kNear, on the guide

  /// Makes the field ready for means, without the index, or for searches, as it is at first. So little is
  /// held at a time: an index, or weights of neighbours, and these are kept until they are dropped. O(n).
  void ready_for_means(const Context& context);
  void ready_for_searches(const Context& context);
  void drop_weights() { near_weight_ = {}; }

  /// The mean of `values` over the nearest points on the same sheet, nearer ones weighing more. Ready for
  /// means. O(n).
  std::vector<float> local_mean(const std::vector<float>& values, const Context& context) const;

  /// Several values of a point, whose means are taken together: reading the neighbours is what takes the
  /// time.
  template <int kCount>
  using Columns = Eigen::Array<float, kCount, 1>;
  template <int kCount>
  std::vector<Columns<kCount>> local_mean(const std::vector<Columns<kCount>>& values,
                                          const Context& context) const;

  /// The neighbours, for one who goes on with them; the field is of no use afterwards.
  NearRows release_neighbors() { return std::move(near_); }

 private:
  Positions guide_;
  std::optional<rfs_mesh::SpatialIndex> index_;
  std::vector<Index> order_;  ///< of the index where there is none
  NearRows near_;
  bool on_lines_;
  std::vector<Local> local_;
  RawArray<std::uint8_t> near_weight_;  ///< of near_, in 1/255: 1 - d^2/r^2; 0 on another sheet;
                                        ///< empty without
};

/// cos^2 of the angle between two normals from its cosine; 0 on another sheet.
inline float same_sheet(float cosine) {
  return cosine < float(rfs_mesh::kSameSheet) ? 0 : cosine * cosine;
}

}  // namespace rfsmooth::smoothing
