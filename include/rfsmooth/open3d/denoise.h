/// rfsmooth for Open3D's users: a `PointCloud` in, the same cloud without the noise, in place.
///
///     rfsmooth::open3d::denoise(*cloud);              // Result: what was done, or what was wrong
///
/// points_ of finite points change; colors_, order and count stay. Normals and covariances, where the cloud
/// has them, describe the surface, which has moved: they are made anew from the smoothed points, normals on
/// the side they were on (normals that had no common side, as EstimateNormals leaves them, outward:
/// rfsmooth/normals.h). A cloud that comes back as it was keeps all of them bit for bit. With the option
/// Outliers::remove the points that have no surface near them go, with all they have.
///
/// Works in double, as Open3D does. Open3D's headers stay in the .cpp: include its own beside this one.
#pragma once

#include <rfsmooth/context.h>
#include <rfsmooth/denoise.h>
#include <rfsmooth/open3d/mesh.h>
#include <rfsmooth/result.h>

namespace open3d::geometry {
class PointCloud;
}  // namespace open3d::geometry

namespace rfsmooth::open3d {

/// What becomes of the covariances of a cloud that has some and whose points moved.
enum class Covariances {
  estimated,  ///< anew, as PointCloud::EstimateCovariances() does: of the 30 nearest smoothed points
  turned,     ///< their own, turned by the least rotation that brings the axis of least spread onto the new
              ///< normal: for covariances of another make (generalised ICP's discs, a sensor's model)
};

/// Denoises the cloud in place. Rows with a NaN or infinite coordinate keep all they have and influence
/// nothing; arrays that are not one per point are left alone. On an error, a cancel or an exception the cloud
/// is untouched. Same bytes out for any number of threads. Errors and cost: those of rfsmooth::denoise.
/// Thread safe on distinct clouds.
Result<DenoiseReport> denoise(::open3d::geometry::PointCloud& cloud, const DenoiseOptions& options = {},
                              const Context& context = {}, Covariances covariances = Covariances::estimated);

}  // namespace rfsmooth::open3d
