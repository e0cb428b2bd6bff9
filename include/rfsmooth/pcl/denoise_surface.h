/// rfsmooth where PCL's `MovingLeastSquares` stands: a cloud in, the smoothed cloud with normals out.
///
///     rfsmooth::pcl::DenoiseSurface<::pcl::PointXYZ, ::pcl::PointNormal> denoise;
///     denoise.setInputCloud(cloud);
///     denoise.process(*surface);
///
/// As rfsmooth::pcl::Denoise (denoise.h), and normal_x, normal_y, normal_z of the finite points in the
/// indices are overwritten with unit normals of the smoothed surface, on one side: towards the viewpoint
/// where there is one, else outward. The other fields of the output are those of the same name in the input
/// (PCL's copyPointCloud); the rest, `curvature` say, is what the point type begins with.
///
/// The output has all points of the input but those that `setOutliers(Outliers::remove)` takes away, in
/// order, unlike that of MovingLeastSquares, which has those in the indices. Points without a normal (not
/// finite, or outside the indices and without one in the input) have NaN there, and `is_dense` is then false,
/// as after PCL's NormalEstimation.
///
/// Errors are reported as denoise.h says, and so are threads. `output` may be the input cloud if In = Out.
/// Compiled from PointXYZ, PointXYZI, PointXYZRGB, PointXYZRGBA and PointXYZL to the type with the same
/// fields and a normal (of PointXYZRGBA, PointXYZRGBNormal), and from PointNormal, PointXYZINormal and
/// PointXYZRGBNormal to themselves. For other pairs, your own types too, include
/// "rfsmooth/pcl/impl/denoise_surface.hpp".
#pragma once

#include <optional>

#include <pcl/point_cloud.h>
#include <pcl/surface/processing.h>

#include <rfsmooth/pcl/denoise.h>

namespace rfsmooth::pcl {

/// The smoothed cloud with normals (see the top of this file).
template <typename PointInT, typename PointOutT>
class DenoiseSurface : public ::pcl::CloudSurfaceProcessing<PointInT, PointOutT>, public DenoiseSettings {
 public:
  using Ptr = ::pcl::shared_ptr<DenoiseSurface<PointInT, PointOutT>>;
  using ConstPtr = ::pcl::shared_ptr<const DenoiseSurface<PointInT, PointOutT>>;
  using PointCloudOut = ::pcl::PointCloud<PointOutT>;

  /// Where the scanner stood, world units: the points that it can see face it, and what they are connected to
  /// follows. Not set: the cloud's sensor origin, if somebody seems to have said it: it or the orientation is
  /// not the default, or the cloud is organised and looks as it would from there.
  void setViewPoint(float x, float y, float z) { viewpoint_ = Eigen::Vector3d(x, y, z); }

  /// Back to how it was before `setViewPoint`.
  void useSensorOriginAsViewPoint() { viewpoint_.reset(); }

  /// As CloudSurfaceProcessing::process; without an input cloud the output is empty and the status says why.
  void process(PointCloudOut& output) override;

 protected:
  void performProcessing(PointCloudOut& output) override;

  /// The sensor origin, if it is known.
  std::optional<Eigen::Vector3d> sensor_place(const ::pcl::PointCloud<PointInT>& cloud) const;

  std::optional<Eigen::Vector3d> viewpoint_;
};

}  // namespace rfsmooth::pcl
