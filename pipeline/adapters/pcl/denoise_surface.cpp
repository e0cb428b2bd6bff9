#include <pcl/point_types.h>

#include <rfsmooth/pcl/denoise_surface.h>
#include <rfsmooth/pcl/impl/denoise_surface.hpp>

// The pairs that lose no field of the input.
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointXYZ, ::pcl::PointNormal);
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointXYZI, ::pcl::PointXYZINormal);
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointXYZRGB, ::pcl::PointXYZRGBNormal);
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointXYZRGBA, ::pcl::PointXYZRGBNormal);
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointXYZL, ::pcl::PointXYZLNormal);
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointNormal, ::pcl::PointNormal);
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointXYZINormal, ::pcl::PointXYZINormal);
PCL_INSTANTIATE_DenoiseSurface(::pcl::PointXYZRGBNormal, ::pcl::PointXYZRGBNormal);
