/// Shapes whose surface is known exactly, for scans, tests and benchmarks. All are centred on the origin and
/// of the order of 1 in size; scale the points, not the shape.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/mesh.h>

#include "clouds/shapes/random.h"
#include "rfs_mesh/points.h"

namespace rfsmooth::clouds {

class Shape {
 public:
  virtual ~Shape() = default;
  Shape() = default;
  Shape(const Shape&) = delete;
  Shape& operator=(const Shape&) = delete;

  /// Exact distance to the surface: negative inside a closed shape, and on the back of an open one.
  virtual double signed_distance(const Eigen::Vector3d& p) const = 0;

  /// Unit outward (front) normal at the surface point nearest to p. On an edge: of one of its faces, or
  /// between them.
  virtual Eigen::Vector3d normal(const Eigen::Vector3d& p) const = 0;

  /// Distance to the nearest sharp edge, or to the rim of an open shape; infinite for a smooth closed shape.
  virtual double edge_distance(const Eigen::Vector3d& p) const;

  /// A lower bound of the distance to the surface that is zero only on it: the step of a ray.
  virtual double clearance(const Eigen::Vector3d& p) const { return std::abs(signed_distance(p)); }

  /// A random point of the surface, as dense as `density` says (uniform by area where it is 1).
  virtual Eigen::Vector3d surface_point(Random& random) const = 0;

  /// Relative sampling density in (0, 1].
  virtual double density(const Eigen::Vector3d&) const { return 1; }

  virtual double area() const = 0;
  virtual std::optional<double> volume() const = 0;  ///< empty: an open shape
  virtual double radius() const = 0;                 ///< of a sphere around the origin that holds the shape

  /// Triangles with outward winding and edges of about `edge`, vertices on the surface; closed for closed
  /// shapes.
  virtual Mesh mesh(double edge) const = 0;
};

/// Radius 1. The lower half (z < 0) is sampled `density_ratio` times more thinly.
std::unique_ptr<Shape> make_sphere(double density_ratio = 1);

/// Around the z axis, ring radius 1, tube radius 0.4.
std::unique_ptr<Shape> make_torus(double ring = 1, double tube = 0.4);

/// Upright solid on a plan of square cells: `plan[row][column]` is '#' where there is material.
std::unique_ptr<Shape> make_prism(const std::vector<std::string_view>& plan, double cell, double height);

std::unique_ptr<Shape> make_cube();                          ///< edge 2
std::unique_ptr<Shape> make_l_part();                        ///< 2 x 2 x 1, two arms of width 0.8
std::unique_ptr<Shape> make_plate(double thickness = 0.06);  ///< 2 x 1.6 x thickness

/// Open: z = 0.15 sin(4 x) cos(3 y) over [-1, 1]^2, front upward.
std::unique_ptr<Shape> make_wavy_sheet();

/// sphere, torus, cube, l_part, plate, wavy_sheet, two_density_sphere (ratio 9).
const std::vector<std::string_view>& shape_names();
std::unique_ptr<Shape> make_shape(std::string_view name);  ///< null if there is none of that name

}  // namespace rfsmooth::clouds
