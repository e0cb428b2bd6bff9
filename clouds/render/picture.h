/// A picture of clouds or meshes from files, side by side from the same place.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "clouds/render/scene.h"
#include "pipeline/cli/render/picture_style.h"

namespace rfsmooth::render {

/// What is shown, and how.
struct PictureOptions {
  std::vector<std::string> inputs, labels;  ///< files; text above each, in order
  std::string title;
  std::optional<Eigen::Vector3d> direction, up;  ///< see CameraOptions
  std::optional<Eigen::Vector3d> zoom;           ///< x, y: shares of the full frame; magnification
  PictureStyle style;
};

struct Picture {
  std::string png;
  std::optional<ColorRange> colors;  ///< what the colours mean, where values have any
};

/// Reads and draws. \throw Failure: a file that cannot be read, no finite point, a field or colours that are
/// not there, two clouds of different size for "displacement", a direction of length zero.
Picture make_picture(const PictureOptions& options, const Context& context);

}  // namespace rfsmooth::render
