/// Rooms that virtual sensors stand in: walls, boxes, balls, pillars and a table on thin legs, in metres. The
/// sensor is at the origin, and every coordinate is its own.
///
/// The parts are exact, and so are where a ray meets a room and how far a point is from its surface.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace rfsmooth::clouds {

/// The faces of a box along the axes. With no extent along one axis: a wall.
struct Box {
  Eigen::Vector3d low, high;
};

/// A sphere.
struct Ball {
  Eigen::Vector3d centre;
  double radius;
};

/// A cylinder along one axis from low to high, without ends.
struct Pillar {
  int axis;
  Eigen::Vector3d centre;  ///< a point of its middle line
  double radius, low, high;
};

/// What stands in a room, its walls too.
struct Room {
  std::vector<Box> boxes;
  std::vector<Ball> balls;
  std::vector<Pillar> pillars;
};

/// For sensors that look around: 24 x 18 m, z upward, the floor 1.5 m below the sensor, no ceiling. A box,
/// two pillars, a ball, a table whose legs are 6 cm thick.
const Room& hall();

/// For cameras that look along z, y downward: the floor 1 m below the camera, a wall 3.2 m before it and one
/// to its left. A box, a ball, a pillar, a table whose legs are 4 cm thick.
const Room& corner();

/// The least t > 0 for which t x `ray` lies on the surface; infinite if there is none.
double meet(const Room& room, const Eigen::Vector3d& ray);

/// From a point to the nearest of the surface.
double distance(const Room& room, const Eigen::Vector3d& p);

}  // namespace rfsmooth::clouds
