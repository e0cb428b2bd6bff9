/// All of rfsmooth but its adapters (rfsmooth/pcl, rfsmooth/open3d, rfsmooth/cgal).
#pragma once

#include <rfsmooth/cloud_file.h>
#include <rfsmooth/compare.h>
#include <rfsmooth/connect.h>
#include <rfsmooth/context.h>
#include <rfsmooth/denoise.h>
#include <rfsmooth/flow.h>
#include <rfsmooth/flow_options.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/normals.h>
#include <rfsmooth/options.h>
#include <rfsmooth/reconstruct.h>
#include <rfsmooth/result.h>
#include <rfsmooth/statistics.h>
#include <rfsmooth/version.h>
