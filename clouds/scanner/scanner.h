/// A laser or structured-light scanner that looks at a shape whose truth is known.
///
/// From each viewpoint a grid of rays is cast at the shape. A return is the range t along the ray, so noise
/// lies along the ray:  sigma(t, a) = noise (t / distance)^range_power / max(cos a, 0.2),  a = angle of
/// incidence, noise = sigma of a surface that faces the scanner from `distance`. A beam has a width: where
/// parts of it meet the surface at different ranges (or pass it and meet the background), the return may lie
/// anywhere between: a mixed pixel. Sources: range noise and incidence, Soudarissanane et al. 2011 ("Scanning
/// geometry: influencing factor on the quality of terrestrial laser scanning points"); mixed pixels, Tang,
/// Huber & Akinci 2007.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <rfsmooth/context.h>
#include <rfsmooth/options.h>

#include "clouds/shapes/shapes.h"

namespace rfsmooth::clouds {

struct ScannerOptions {
  int views = 8;              ///< viewpoints around the shape, alternating above and below
  int columns = 60;           ///< rays across
  int rows = 60;              ///< rays down
  double distance = 4;        ///< from the centre of the shape, world units
  std::string model = "ray";  ///< ray | isotropic
  double noise =
      0.01;  ///< sigma facing the surface at `distance` (ray) or everywhere (isotropic), world units
  double range_power = 2;  ///< growth of the noise with range
  double beam = 0;         ///< width of the beam, x step between rays; 0 = no mixed pixels
  double background = 3;   ///< how far behind the shape's centre a beam that misses ends, world units
  double outliers = 0;     ///< stray points, share of the returns
  double dropout =
      0;  ///< share of the returns lost at one end of the x axis, none at the other: uneven density
  double elevation = 25;  ///< of the viewpoints above or below the equator, degrees

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"views", "viewpoints around the shape", "", 1, 1000}, self.views);
    visit(OptionInfo{"columns", "rays across", "rays", 1, 10000}, self.columns);
    visit(OptionInfo{"rows", "rays down", "rays", 1, 10000}, self.rows);
    visit(OptionInfo{"distance", "from the centre of the shape", "world units", 0.1, 1e6}, self.distance);
    visit(OptionInfo{"model", "noise along the ray or isotropic", "", 0, 0, {"ray", "isotropic"}},
          self.model);
    visit(OptionInfo{"noise", "standard deviation facing the surface", "world units", 0, 1e6}, self.noise);
    visit(OptionInfo{"range-power", "growth of the noise with range", "", 0, 10}, self.range_power);
    visit(OptionInfo{"beam", "width of the beam; 0 = no mixed pixels", "x step between rays", 0, 10},
          self.beam);
    visit(OptionInfo{"background", "how far behind the centre the background is", "world units", 0, 1e6},
          self.background);
    visit(OptionInfo{"outliers", "stray points, share of the returns", "", 0, 0.5}, self.outliers);
    visit(OptionInfo{"dropout", "share of returns lost at low x, falling to none at high x", "", 0, 0.99},
          self.dropout);
    visit(OptionInfo{"elevation", "of the viewpoints above or below the equator", "degrees", 0, 89},
          self.elevation);
  }
};

enum class ReturnKind : std::uint8_t { none, surface, mixed, stray };

/// One ray: what the scanner says, and what is true.
struct Return {
  ReturnKind kind = ReturnKind::none;
  Eigen::Vector3d measured = Eigen::Vector3d::Zero();
  Eigen::Vector3d truth =
      Eigen::Vector3d::Zero();  ///< on the surface: where the ray met it, else nearest to `measured`
  double intensity = 0;         ///< cosine of the incidence, 0 for strays
  int view = 0;
};

/// Returns of all views, view after view, row after row; `none` where nothing was hit. Parallel over rays,
/// same bytes for any number of threads: every ray draws from its own generator. \throw Failure (usage) if an
/// option is out of range.
std::vector<Return> scan(const Shape& shape, const ScannerOptions& options, std::uint64_t seed,
                         const Context& context);

}  // namespace rfsmooth::clouds
