/// Measures a cloud against the truth: a mesh, a clean cloud, or both.
///
/// With d(p, S) the exact distance to the true surface S, P the cloud, C the clean cloud:
///   point-to-surface  p2s = mean over P of d(p, S)^2, its root and the largest d (one way)
///   Chamfer           CD  = mean over P of d(p, C)^2 + mean over C of d(c, P)^2
///   P2M               = p2s + mean over the *faces* of S of d(face, P)^2, not weighted by area
///   shrinkage         = mean signed distance x area / volume, for a closed S; positive: outside
///   evenness          = standard deviation / mean of the distances to the nearest other point
///   normal error      = mean angle to the true normal, of the nearest face or clean point
///
/// P2M exists to stand beside published tables only; compare methods by p2s and CD. CD is that of Fan, Su and
/// Guibas 2017, "A point set generation network for 3D object reconstruction from a single image", section
/// 4.1, with means for their sums; P2M is as Luo and Hu 2021, "Score-based point cloud denoising", take it
/// (PyTorch3D's point_mesh_face_distance).
///
/// Units: the cloud's own. `on_unit_sphere` rescales to the unit sphere of the truth (the clean cloud if
/// there is one, else the mesh's vertices): centre of its bounding box, largest distance from there = 1.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/result.h>

namespace rfsmooth {

/// The caller's points: n x 3 row-major, world units; `normals` is n x 3 too, or null.
struct CloudView {
  const double* xyz = nullptr;
  std::size_t n = 0;
  const double* normals = nullptr;
};

/// The caller's triangles: vertices n x 3, faces m x 3.
struct MeshView {
  const double* xyz = nullptr;
  std::size_t n = 0;
  const Face* faces = nullptr;
  std::size_t m = 0;
};

/// What is known of the surface: a mesh, a clean cloud, or both.
struct Truth {
  std::optional<MeshView> mesh;    ///< gives p2s, P2M, shrinkage
  std::optional<CloudView> cloud;  ///< gives CD
};

/// How to compare.
struct CompareOptions {
  bool signed_normals = false;  ///< the cloud's normals claim a side: angles up to 180 degrees instead of 90
};

/// One line of the table below: how a figure is called, what it means, and the power of length it carries.
struct MeasureInfo {
  std::string_view name;
  std::string_view help;
  int length_power;
};

/// Empty = the truth or the cloud does not have what it takes.
struct Measures {
  std::optional<double> p2s_mean_square, p2s_root, p2s_max;
  std::optional<double> faces_to_cloud, p2m;
  std::optional<double> to_clean, from_clean, chamfer;
  std::optional<double> mean_signed_distance, shrinkage;
  std::optional<double> spacing, evenness;
  std::optional<double> normal_error;

  /// Names every figure once, for text, JSON, tables and rescaling: visit(MeasureInfo, value).
  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(MeasureInfo{"p2s_mean_square", "point to surface: mean squared distance", 2}, self.p2s_mean_square);
    visit(MeasureInfo{"p2s_root", "point to surface: root of the mean square", 1}, self.p2s_root);
    visit(MeasureInfo{"p2s_max", "point to surface: largest distance", 1}, self.p2s_max);
    visit(MeasureInfo{"faces_to_cloud", "true faces to nearest point: mean squared distance", 2},
          self.faces_to_cloud);
    visit(MeasureInfo{"p2m", "P2M: point to surface + faces to cloud", 2}, self.p2m);
    visit(MeasureInfo{"to_clean", "points to nearest clean point: mean squared distance", 2}, self.to_clean);
    visit(MeasureInfo{"from_clean", "clean points to nearest point: mean squared distance", 2},
          self.from_clean);
    visit(MeasureInfo{"chamfer", "Chamfer: both together", 2}, self.chamfer);
    visit(MeasureInfo{"mean_signed_distance", "mean signed distance, positive outside", 1},
          self.mean_signed_distance);
    visit(MeasureInfo{"shrinkage", "mean signed distance x area / volume", 0}, self.shrinkage);
    visit(MeasureInfo{"spacing", "mean distance to the nearest other point", 1}, self.spacing);
    visit(MeasureInfo{"evenness", "standard deviation / mean of those distances", 0}, self.evenness);
    visit(MeasureInfo{"normal_error", "mean angle to the true normal, degrees", 0}, self.normal_error);
  }
};

/// The figures of a comparison; empty where the truth does not give them.
struct CompareReport {
  std::size_t points = 0;        ///< rows of the cloud
  std::size_t finite = 0;        ///< rows measured
  std::size_t truth_points = 0;  ///< finite rows of the clean cloud
  std::size_t truth_faces = 0;   ///< faces of the true mesh
  bool truth_closed = false;     ///< the true mesh encloses a volume
  double radius = 0;             ///< of the truth's unit sphere, world units
  Measures own_units;
  /// One per row of the cloud: its distance to the true mesh, without one to the nearest clean point; world
  /// units. NaN for rows that are not finite.
  std::vector<double> deviation;
};

/// The figures as they would be on a sphere of radius 1: lengths / radius, squares / radius^2. A truth of one
/// place has no such sphere (radius 0): then lengths and squares are empty.
Measures on_unit_sphere(const Measures& own_units, double radius);

/// Measures the finite rows of `cloud`. Errors: no_usable_points if the cloud or the truth has no finite
/// point (or no face), input_unreadable if a face names a missing or non-finite vertex, cancelled,
/// out_of_memory. \throw std::invalid_argument if `truth` is empty. O(n log n), parallel, same bits for any
/// number of threads; thread-safe.
Result<CompareReport> compare(const CloudView& cloud, const Truth& truth, const CompareOptions& options,
                              const Context& context);

}  // namespace rfsmooth
