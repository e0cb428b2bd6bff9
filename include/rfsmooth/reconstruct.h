/// From a noisy cloud to a surface:
///
///     denoise -> distinct points -> oriented normals -> a method of reconstruction -> clean up -> whose
///     point is each vertex
///
/// The methods are other people's (Open3D's, CGAL's) and come in from outside as a `SurfaceMethod`, so that
/// this room needs neither library; here is what they have in common: the scale they work at, taken from the
/// measured spacing, and what a surface still needs afterwards. Vollmer et al. 1999 end in figure 16 in the
/// same way: a cloud smoothed first can be reconstructed by methods that noise defeats.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <rfsmooth/denoise.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/normals.h>

namespace rfsmooth {

/// How to reconstruct, whatever the method.
struct ReconstructOptions {
  bool denoise = true;  ///< take the noise out first
  /// Poisson: faces with a corner farther than this from every point go. On the development shapes with 2 %
  /// noise the holes that it leaves can be filled from 2.5 spacings on; more leaves more of the flaps that
  /// Poisson invents where normals disagree.
  Length trim = {2.5, true};
  Length fill_holes = {8, true};  ///< the longest edge of a face put into a hole; 0 = none are filled
  /// Outliers are removed, or smoothed; a surface cannot keep them beside it.
  DenoiseOptions denoising = {{}, Outliers::remove};
  NormalsOptions normals = {};  ///< which side is outside: without a viewpoint as estimate_normals finds it

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"denoise", "take the noise out first", ""}, self.denoise);
    visit(OptionInfo{"trim", "poisson: drop faces that are farther than this from every point; 0 keeps all",
                     "world units or x spacing", 0},
          self.trim);
    visit(OptionInfo{"fill-holes", "fill holes that need no edge longer than this; 0 leaves them open",
                     "world units or x spacing", 0},
          self.fill_holes);
    DenoiseOptions::describe(self.denoising, visit,
                             words("outliers",
                                   "points with no surface near: left out, or smoothed and joined to the "
                                   "surface like all others",
                                   {"", "", "remove", "smooth"}));
  }
};

/// What a method of reconstruction is given. Points are finite and distinct, around a local origin.
struct SurfaceInput {
  Positions points;    ///< n x 3
  Positions normals;   ///< n x 3, unit, on one side (rfsmooth/normals.h): outward on closed shapes, or
                       ///< towards the viewpoint
  double spacing = 0;  ///< mean distance to the nearest neighbour, after denoising; world units
};

/// A way of making a surface, as the adapters offer it.
struct SurfaceMethod {
  std::string name;  ///< as --method takes it
  /// Closes every gap, however wide: its faces far from the points are trimmed.
  bool closes_all = false;
  std::function<Result<Mesh>(const SurfaceInput& input, const Context& context)> run;
};

/// How the faces of a mesh hang together.
struct Topology {
  std::size_t vertices = 0;  ///< that a face uses
  std::size_t edges = 0, faces = 0;
  std::size_t components = 0;         ///< pieces that hang together through vertices
  std::size_t boundary_edges = 0;     ///< with one face
  std::size_t boundary_loops = 0;     ///< pieces that the boundary edges make: rims and holes
  std::size_t crowded_edges = 0;      ///< with three faces or more
  std::size_t disagreeing_edges = 0;  ///< with two faces that run along it in the same direction
  std::size_t pinched_vertices = 0;   ///< whose faces make more than one fan or ring
  long genus = 0;                     ///< handles, if `manifold()`

  bool manifold() const { return crowded_edges == 0 && disagreeing_edges == 0 && pinched_vertices == 0; }
  bool closed_manifold() const { return manifold() && boundary_edges == 0 && faces > 0; }
};

/// What was done.
struct ReconstructReport {
  DenoiseReport denoised;     ///< as it came; all zero if denoising was left out
  double spacing = 0;         ///< that the method worked with, world units
  std::size_t raw_faces = 0;  ///< that the method made
  std::size_t filled = 0;     ///< holes filled afterwards
  Topology topology;          ///< of what is given back
  std::vector<StageTime> seconds;
};

/// The surface, and what was done.
struct Reconstruction {
  Mesh mesh;                     ///< world units; every vertex has a face
  std::vector<std::size_t> row;  ///< of each vertex: the row of the cloud nearest to it, for its colour
  ReconstructReport report;
};

/// Makes a surface from n x 3 row-major coordinates (world units; rows that are not finite, and outliers that
/// denoising found, are left out). Pieces of fewer than 200 faces (100 of a method that closes all) are
/// dropped as specks unless all are so small. Errors: as `denoise`, and what the method says;
/// no_usable_points if there is no surface, or fewer than four distinct points are left. The same bytes for
/// any number of threads if the method's are. O(n log n) beside the method. Thread safe if the method is.
Result<Reconstruction> reconstruct(std::vector<double> xyz, const ReconstructOptions& options,
                                   const SurfaceMethod& method, const Context& context);

}  // namespace rfsmooth
