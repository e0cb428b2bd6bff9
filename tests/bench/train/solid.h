/// Solids as signed distances, and their surfaces as meshes with sharp edges.
#pragma once

#include <functional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <rfsmooth/mesh.h>

namespace rfsmooth::bench {

/// Negative inside; about the distance near the surface.
using Solid = std::function<double(const Eigen::Vector3d&)>;

Solid box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double rounding = 0);
/// From a to b, round, as thick there as the radii say.
Solid limb(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius_a, double radius_b);
Solid cylinder(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius);
Solid half_space(const Eigen::Vector3d& outward, double offset);

Solid united(Solid a, Solid b);
Solid blended(Solid a, Solid b, double width);  ///< united, with a fillet of that width
Solid without(Solid a, Solid b);
Solid placed(Solid a, const Eigen::Isometry3d& motion);
/// With ripples: `height` times a number in [-1, 1] that varies over `wavelength` in three directions.
Solid rippled(Solid a, double height, double wavelength, const Eigen::Matrix3d& directions, bool creased);
Solid shell(Solid a, double thickness);  ///< of the surface, to both sides alike

/// The surface inside the box, of cells with edges of `cell`, by dual contouring: a corner a cell, where the
/// tangent planes at the cell's edges meet (Ju et al. 2002). Parts thinner than a cell are lost.
Mesh surface_of(const Solid& solid, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double cell);

}  // namespace rfsmooth::bench
