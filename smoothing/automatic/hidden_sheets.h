/// Two sheets of a wall so thin that the noise hides that there are two.
///
/// Below about two sigma between them, the points of both scatter about the middle like those of one sheet,
/// only wider: with variance v > c where the rest of the cloud has c. What pulls every point to the middle
/// would then make a film of the wall. With d^2 = v - c, a point whose residual is e goes to the height d s
/// over the middle; s is its expected label where d^2 <= c / 2, and the sharpened one beyond (two_sheets.h).
/// That puts nearly all points on the nearer sheet, which for up to a quarter of them is the wrong one: on
/// rotor (10,000 points, noise of 2 %) the mean squared distance to the surface is 0.13 instead of 0.17 of
/// sigma^2, 93 % of the normals point outward instead of 87 %, and Poisson's surface has half of the error.
/// Where the sheets are nearer to each other the label is a guess and its expectation is better: at 3 %
/// sharpening makes the distance 0.127 instead of 0.12 of sigma^2.
///
/// Noise that is louder in some places has a larger v as well, and no neighbourhood has the points to tell
/// (one nat takes some 500 of them); the cloud as a whole does. The evidence of two sheets against one sheet
/// with louder noise, a likelihood ratio of two simple hypotheses (two_sheets.h), is added up over all points
/// with v > 1.3 c, in noise of variance c (1 - 2 own), which is what smoothing left of c. From it
/// (ln c)^2 / 2 (0.15)^2 is taken off for a noise that was measured wrongly, and the c is taken where the
/// rest is largest. Walls make the measured noise too high themselves, so c must be found.
///
/// v is the mean of the other points around: one that holds a share w of the point itself adds w r^2 nats,
/// with r = d^2 / v, to what two sheets would bring, about r^4 / 12 (1 - r). For thin walls, where r is 0.3,
/// that is as much again at w = 0.01, and it is there without walls, too, and grows with their points.
///
/// Sheets no farther apart than points are from their nearest are layers, of two scans that do not quite
/// meet, and nobody is moved onto them (squared_nearest of two_sheets.h; the noise is measured by the same).
///
/// Nor is anybody where the places that look like two sheets have no more points on the same area than the
/// others: two sheets have twice as many, and even if only a tenth of these places had two, they would be 5 %
/// denser. Several scans that do not meet have as many everywhere (1.5 to 3 % more; rotor 10 to 70 %).
///
/// Residuals in steps (depths of a sensor) look a little like two sheets in some places, so walls are
/// believed only if they take at least a twentieth of the cloud. Uniform noise looks like two sheets
/// everywhere, so they are not believed if they take more than three quarters of it, unless the noise is
/// known to have tails. Nor are they looked for in noise of less than a tenth of a spacing (detail() of
/// noise_levels.h): what it hides are layers of scans that do not quite meet, or a rough surface.
#pragma once

#include <optional>
#include <vector>

#include <rfsmooth/statistics.h>

#include "smoothing/automatic/guide/height_field.h"

namespace rfsmooth::smoothing {

/// Walls are believed only if they take at least this share of the cloud's points; thin_walls.cpp uses it,
/// too.
constexpr double kLeastSheetShare = 0.05;

/// What was found.
struct HiddenSheets : Statistics::Sheets {
  /// Whether the cloud has such walls. A part of it may have none of their points.
  bool there() const;
};

/// What smoothing left of the data.
struct Residuals {
  std::vector<float> scores;  ///< n: standard normal where there is one sheet
  double unit = 0;            ///< what a score of 1 is near 0, world units
  double apart = 0;           ///< NoiseModel::apart
  bool with_tails = false;    ///< whether the law that they are the scores of has tails (tails.h)
};

/// Moves `height` (n: the smoothed heights over the field, world units) of points on hidden sheets to the
/// nearer one, or almost. `own` (n): each point's share of its own height in its smoothed height (patches.h).
/// It is not changed here, so for the points that were moved it is too small afterwards. O(n); parallel, the
/// same bits for any number of threads. Thread safe.
/// \param whole points of the cloud that the field is of, over its own: so many times its evidence counts.
/// \param known evidence and c, taken if they are there, else entered.
HiddenSheets split_hidden_sheets(const HeightField& field, const Residuals& left, std::vector<float>& height,
                                 const std::vector<float>& own, double whole,
                                 std::optional<Statistics::Sheets>& known, const Context& context);

}  // namespace rfsmooth::smoothing
