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
/// Only `setOutliers(Outliers::remove)` takes points away, by PCL's rules: the rest closes up to height 1,
/// or, with `setKeepOrganized(true)`, the removed ones stay as NaN (`setUserFilterValue`) and is_dense
/// becomes false. A filter made with `true` tells which: `getRemovedIndices()`.
///
/// What is wrong with an input (none set, no finite point, an index out of range) or an option is not thrown:
/// `filter` gives a PCL_ERROR, an empty output and a line in `getStatus()`. Setters only remember: a value
/// out of range, a flow that there is not, or an option that the flow has not is reported by every `filter`
/// until it is mended.
///
/// Compiled for the XYZ types of PCL; for your own registered point type include
/// "rfsmooth/pcl/impl/denoise.hpp". Thread safety: one object per thread, as for every PCL filter. Cost and
/// determinism: see rfsmooth/denoise.h.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include <pcl/filters/filter.h>

#include <rfsmooth/denoise.h>

namespace rfsmooth::pcl {

/// What every Denoise has, whatever its point type.
class DenoiseSettings {
 public:
  /// All options at once; the defaults need no setting.
  void setOptions(const DenoiseOptions& options);
  const DenoiseOptions& getOptions() const { return options_; }

  /// The flow by name ("auto", "hc", ...: rfsmooth::flows() has all), with its own defaults.
  void setFlow(const std::string& name);
  std::string getFlow() const { return std::string(name_of(options_.flow.flow)); }

  /// Flow "auto": times the strength that the measured noise asks for, 0 to 10 (default 1; 0 = nothing
  /// moves).
  void setStrength(double strength);

  /// Flow "auto": the standard deviation of the noise along the normal, world units, at least 0, instead of
  /// measuring it.
  void setNoise(double sigma);

  /// What becomes of points with no surface near (default: left in place, pulling nobody).
  void setOutliers(Outliers what) { options_.outliers = what; }
  Outliers getOutliers() const { return options_.outliers; }

  /// Whether removed points stay in the cloud with their coordinates set to the filter value (default: NaN).
  void setKeepOrganized(bool keep) { keep_organized_ = keep; }
  bool getKeepOrganized() const { return keep_organized_; }
  void setUserFilterValue(float value) { user_filter_value_ = value; }

  /// Number of threads; 0 (default) = all cores. The result is the same for every value.
  void setNumberOfThreads(unsigned int threads = 0) { context_.threads = static_cast<int>(threads); }
  int getNumberOfThreads() const { return context_.threads; }

  /// What the last `filter` did.
  const DenoiseReport& getReport() const { return report_; }

  /// Empty after a success; else one line that says what was wrong.
  const std::string& getStatus() const { return status_; }

 protected:
  /// Denoises n x 3 coordinates in place, row-major, world units; false, after `fail`, if it cannot be done.
  bool run(double* xyz, std::size_t n);

  /// Writes unit normals of n x 3 coordinates (rfsmooth/normals.h); false as for `run`.
  bool run_normals(const double* xyz, std::size_t n, const std::optional<Eigen::Vector3d>& viewpoint,
                   double* normals);

  /// Whether an organised cloud, width x height rows of 3, looks as it would from the origin.
  bool seen_from_origin(const double* xyz, std::size_t width, std::size_t height) const;

  /// Sets the status and prints it by PCL_ERROR; false.
  bool fail(const std::string& why);

  /// The options of the flow "auto"; null, and a mistake, if another is set.
  AutomaticOptions* automatic(const char* option);

  /// Those of `indices`, the rows of the last run, that are to be removed: ascending, each once.
  ::pcl::Indices removed(const ::pcl::Indices& indices) const;

  DenoiseOptions options_;
  DenoiseReport report_;
  Context context_;
  std::string status_;   ///< the last run's
  std::string mistake_;  ///< the setters', reported by every run until it is mended
  bool keep_organized_ = false;
  float user_filter_value_ = std::numeric_limits<float>::quiet_NaN();
};

/// The filter (see the top of this file).
template <typename PointT>
class Denoise : public ::pcl::Filter<PointT>, public DenoiseSettings {
 public:
  using Ptr = ::pcl::shared_ptr<Denoise<PointT>>;
  using ConstPtr = ::pcl::shared_ptr<const Denoise<PointT>>;
  using PointCloud = typename ::pcl::Filter<PointT>::PointCloud;

  explicit Denoise(bool extract_removed_indices = false) : ::pcl::Filter<PointT>(extract_removed_indices) {
    this->filter_name_ = "Denoise";
  }

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
  explicit Denoise(bool extract_removed_indices = false)
      : ::pcl::Filter<::pcl::PCLPointCloud2>(extract_removed_indices) {
    filter_name_ = "Denoise";
  }
  void filter(PCLPointCloud2& output);

 protected:
  void applyFilter(PCLPointCloud2& output) override;
};

}  // namespace rfsmooth::pcl
