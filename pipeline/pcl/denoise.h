/// rfsmooth as a PCL filter: `rfsmooth::pcl::Denoise<PointT>` takes the noise out of a cloud and leaves the
/// rest of it alone.
///
///     rfsmooth::pcl::Denoise<::pcl::PointXYZRGB> denoise;
///     denoise.setInputCloud(cloud);
///     denoise.filter(*cleaned);
///
/// The output starts as a copy of the input; then x, y, z of the finite points in the indices are
/// overwritten. All other fields, header, stamp, width x height, is_dense, sensor origin and orientation,
/// order and count stay. Coordinates are computed in double around a local origin and rounded once, to
/// nearest. Points outside the indices influence nothing.
///
/// Nothing throws through `filter` and nothing aborts: an unusable input (none set, no finite point, an index
/// out of range, an option out of range) gives a PCL_ERROR, an empty output and a line in `getStatus()`.
///
/// Compiled for the XYZ types of PCL; for your own registered point type include
/// "rfsmooth/pcl/impl/denoise.hpp". Thread safety: one object per thread, as for every PCL filter. Cost and
/// determinism: see pipeline/denoise.h.
#pragma once

#include <optional>
#include <string>

#include <pcl/filters/filter.h>

#include "rfsmooth/pipeline/denoise.h"

namespace rfsmooth::pcl {

/// What every Denoise has, whatever its point type.
class DenoiseSettings {
 public:
  /// All options at once; the defaults need no setting.
  void setOptions(const pipeline::DenoiseOptions& options) { options_ = options; }
  const pipeline::DenoiseOptions& getOptions() const { return options_; }

  /// The flow by name ("auto", "hc", ...; see `rfsmooth flows`).
  void setFlow(const std::string& name) { options_.flow.flow = name; }
  const std::string& getFlow() const { return options_.flow.flow; }

  /// Number of threads; 0 (default) = all cores. The result is the same for every value.
  void setNumberOfThreads(unsigned int threads = 0) { context_.threads = static_cast<int>(threads); }
  int getNumberOfThreads() const { return context_.threads; }

  /// What the last `filter` did.
  const pipeline::DenoiseReport& getReport() const { return report_; }

  /// Empty after a success; else one line that says what was wrong.
  const std::string& getStatus() const { return status_; }

 protected:
  /// Denoises n x 3 coordinates in place; false, with the status set and PCL_ERROR printed, if it cannot be
  /// done.
  bool run(double* xyz, std::size_t n);

  /// Writes unit normals of n x 3 coordinates (pipeline/normals.h); false as for `run`.
  bool run_normals(const double* xyz, std::size_t n, const std::optional<Eigen::Vector3d>& viewpoint,
                   double* normals);

  bool fail(const std::string& why);

  pipeline::DenoiseOptions options_;
  pipeline::DenoiseReport report_;
  Context context_;
  std::string status_;
};

/// The filter (see the top of this file). `filter(indices)` gives the indices it works on.
template <typename PointT>
class Denoise : public ::pcl::Filter<PointT>, public DenoiseSettings {
 public:
  using Ptr = ::pcl::shared_ptr<Denoise<PointT>>;
  using ConstPtr = ::pcl::shared_ptr<const Denoise<PointT>>;
  using PointCloud = typename ::pcl::Filter<PointT>::PointCloud;

  Denoise() { this->filter_name_ = "Denoise"; }

  /// As in the base class; without an input cloud the output is empty instead of untouched.
  /// `output` may be the input cloud.
  void filter(PointCloud& output);

 protected:
  void applyFilter(PointCloud& output) override;
};

/// The same for a cloud of any fields (x, y, z in FLOAT32 or FLOAT64, which keep their type).
template <>
class Denoise<::pcl::PCLPointCloud2> : public ::pcl::Filter<::pcl::PCLPointCloud2>, public DenoiseSettings {
 public:
  Denoise() { filter_name_ = "Denoise"; }
  void filter(PCLPointCloud2& output);

 protected:
  void applyFilter(PCLPointCloud2& output) override;
};

}  // namespace rfsmooth::pcl
