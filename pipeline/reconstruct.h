/// From a noisy cloud to a surface:
///
///     denoise -> distinct points -> a method of reconstruction -> drop specks, fill pinholes -> whose point
///     is each vertex
///
/// The methods are other people's (Open3D's, CGAL's) and come in from outside as a `SurfaceMethod`, so that
/// this room needs neither library; here is what they have in common: the scale they work at, taken from the
/// measured spacing, and what a surface still needs afterwards. Vollmer et al. 1999 end in figure 16 in the
/// same way: a cloud smoothed first can be reconstructed by methods that noise defeats.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rfsmooth/pipeline/denoise.h"
#include "rfsmooth/pipeline/topology.h"
#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::pipeline {

struct ReconstructOptions {
  std::string method = "advancing-front";
  bool denoise = true;
  DenoiseOptions denoising;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    OptionInfo method{"method", "how the surface is made", ""};
    method.choices = {"advancing-front"};
    visit(method, self.method);
    visit(OptionInfo{"denoise", "take the noise out first", ""}, self.denoise);
    DenoiseOptions::describe(self.denoising, visit);
  }
};

/// What a method of reconstruction is given. Points are finite and distinct, around a local origin.
struct SurfaceInput {
  Positions points;    ///< n x 3
  double spacing = 0;  ///< mean distance to the nearest neighbour, after denoising; world units
};

/// A way of making a surface, as the adapters offer it.
struct SurfaceMethod {
  std::string name;  ///< as --method takes it
  std::function<Result<rfs_mesh::Mesh>(const SurfaceInput& input, const Context& context)> run;
};

struct ReconstructReport {
  DenoiseReport denoised;  ///< as it came; all zero if denoising was left out
  double spacing = 0;      ///< that the method worked with, world units
  Topology topology;
  std::vector<StageTime> seconds;
};

struct Reconstruction {
  rfs_mesh::Mesh mesh;  ///< world units; every vertex has a face
  std::vector<std::size_t>
      row;  ///< of each vertex: the row of the cloud nearest to it, whose colour it takes
  ReconstructReport report;
};

/// Makes a surface from n x 3 row-major coordinates (world units; rows that are not finite are left out).
/// Errors: as `denoise`, and what the method says; no_usable_points if there is no surface. The same bytes
/// for any number of threads if the method's are.
Result<Reconstruction> reconstruct(std::vector<double> xyz, const ReconstructOptions& options,
                                   const SurfaceMethod& method, const Context& context);

}  // namespace rfsmooth::pipeline
