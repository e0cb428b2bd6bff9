/// What is drawn: a cloud or a mesh from a file, with what its colours and shading need.
#pragma once

#include <string>
#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "clouds/render/camera.h"
#include "clouds/render/image.h"
#include "pipeline/io/table/cloud.h"

namespace rfsmooth::render {

struct Scene {
  Positions points;        ///< the finite points around `origin`
  std::vector<Index> row;  ///< of each point in the file
  std::vector<Face> faces;
  std::vector<Edge> edges;
  Positions normals;  ///< per point: of the plane through its nearest neighbours; empty where faces are drawn
  std::vector<double> reach;  ///< per point: radius of its splat, world units
  std::vector<Color> colors;  ///< per point
  bool is_mesh() const { return !faces.empty() || !edges.empty(); }
};

/// Finite points, faces and edges of a file, relative to `origin`. \throw Failure if there is no finite
/// point.
Scene make_scene(const pipeline::io::Cloud& cloud, const Eigen::Vector3d& origin, const Context& context);

/// Takes strays and mixed pixels (pipeline/outliers.h) out of a scene without faces or edges, before its
/// normals are estimated.
void leave_out_outliers(Scene& scene, const Context& context);

/// Normals from the `neighbors` nearest points each: few, so that noise shows as grain instead of being
/// averaged away. Splats reach about as far as the sixth neighbour, at most three times the median (strays
/// stay small).
void estimate_surfels(Scene& scene, int neighbors, const Context& context);

/// What a value means in a picture: `low` is dark blue, `high` yellow.
struct ColorRange {
  double low = 0, high = 1;
};

/// Colours from one value per point; those that are not finite become grey.
void color_by(Scene& scene, const std::vector<double>& values, const ColorRange& range);

/// The range of `values` without the outermost 2 % on either side.
ColorRange usual_range(std::vector<double> values);

/// The file's own colours (red green blue, or PCL's rgb / rgba); false if it has none.
bool color_by_file(Scene& scene, const pipeline::io::Cloud& cloud);

struct DrawOptions {
  bool edges = false;      ///< draw the edges of faces too
  double splat_scale = 1;  ///< of every splat's radius
};

/// Draws the scene as seen by `camera` in a picture of width x height.
Image draw(const Scene& scene, const Camera& camera, int width, int height, const DrawOptions& options);

}  // namespace rfsmooth::render
