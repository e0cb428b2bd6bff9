/// The scale of a LAS file: the step that its coordinates are rounded to.
#pragma once

#include <array>
#include <optional>

#include "pipeline/io/table/cloud.h"

namespace rfsmooth::pipeline::io {

/// What was done to scales that are coarser than asked for.
struct RefinedScale {
  std::array<double, 3> before{}, after{};  ///< by axis; the same where nothing was done
  std::array<double, 3> shift{};  ///< of the offset, in old steps: the old one left no room in 32 bits
  bool refined() const { return before != after; }
  bool moved_offset() const { return shift != std::array<double, 3>{}; }
  double coarsest() const;  ///< of the axes, after; positive
};

/// The coarsest step that costs one per cent at most of what smoothing reached: half of the noise that it
/// left, as rounding to steps q adds q / sqrt(12) in every direction and sqrt(1 + 1 / 48) is 1.01. No
/// `left`, or one as large as the noise, tells nothing: then a tenth of the noise is taken for it, as little
/// as smoothing leaves of white noise on smooth shapes. World units; 0 without noise.
double finest_needed(double noise, std::optional<double> left);

/// The same where the scale may be refined; where it is `kept`, any step is fine enough.
double finest_asked(bool kept, double noise, std::optional<double> left);

/// What is left of the noise once coordinates are rounded to steps of `step`.
double with_rounding(double left, double step);

/// A change of an axis: integers become (old - shift) * 10^power.
struct ScaleChange {
  int power = 0;
  double shift = 0;
};

/// Gives the field of an axis steps of at most `step`, as far as its integers fit into 32 bits, and enters
/// the axis into `done`. Returns how its integers are to be changed. `low`, `high`: the ends of its old and
/// new coordinates, in old steps; low > high where there are none.
ScaleChange refine_axis(Field& field, std::size_t axis, double step, double low, double high,
                        RefinedScale& done);

/// Changes an integer, in place: 4 bytes.
void change_integer(char* at, const ScaleChange& change);

/// Gives each axis of a LAS cloud a scale of at most `step`, the old one over a power of ten, before
/// coordinates `xyz` (n x 3) are set: integers become 10^k times what they were, so that points stay where
/// they are to the last digit. As far as both old and new coordinates fit into 32 bits; the offset stays if
/// that is enough, else it moves by a whole number of old steps. Every point keeps its place. O(n).
RefinedScale refine_scale(Cloud& las, double step, const double* xyz, const Context& context);

/// The finest power of ten that `steps` fit into `extent`; 1e-3 for an extent of 0.
double decimal_scale(double extent, double steps);

/// A decimal number times ten to the `power`, without the rounding of a division: 0.01 and -1 give 0.001.
double times_power_of_ten(double value, int power);

}  // namespace rfsmooth::pipeline::io
