/// Where a picture is taken from: an orthographic camera, found from the cloud or set by hand.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "rfs_mesh/points.h"

namespace rfsmooth::render {

struct CameraOptions {
  std::optional<Eigen::Vector3d> direction;  ///< from the eye into the scene; empty = from the principal axes
  std::optional<Eigen::Vector3d> up;         ///< points up in the picture; empty = z, or y if looking along z
  double centre_x = 0.5, centre_y = 0.5;  ///< middle of the picture in the full frame, from its left and top
  double zoom = 1;                        ///< magnification of the full frame
};

/// Picture coordinates: x to the right and y down in pixels, depth in pixels toward the viewer.
class Camera {
 public:
  /// Frames the finite `points` in a picture of width x height pixels; the furthest 0.2 % on each side do not
  /// count.
  Camera(const Positions& points, const CameraOptions& options, int width, int height);

  Eigen::Vector3d project(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d d = p - centre_;
    return {middle_[0] + scale_ * right_.dot(d), middle_[1] - scale_ * up_.dot(d), scale_ * toward_.dot(d)};
  }
  /// A direction in camera axes: right, up, toward the viewer.
  Eigen::Vector3d turn(const Eigen::Vector3d& v) const { return {right_.dot(v), up_.dot(v), toward_.dot(v)}; }
  double scale() const { return scale_; }  ///< pixels per world unit

 private:
  Eigen::Vector3d right_, up_, toward_, centre_ = Eigen::Vector3d::Zero();
  Eigen::Vector2d middle_;
  double scale_ = 1;
};

}  // namespace rfsmooth::render
