/// By how much noise must differ from other noise, or from none, to be told from it: one number each, for all
/// that measure noise and all that ask what was measured.
#pragma once

namespace rfsmooth::rfs_mesh {

/// Spacings: noise below this cannot be told from detail. Where points are more than twice as dense as on
/// the mean their own spacing counts: there they show more. In a cloud that has more noise elsewhere, any is
/// told where eight times the neighbours show no more scatter, or hardly: detail would.
inline constexpr double kNoNoise = 0.05;

/// What may be detail on a surface that is anything but smooth.
constexpr double detail(double spacing) {
  return 2 * kNoNoise * spacing;
}

/// Times: by so much one noise differs from itself, told by other places or by more neighbours.
constexpr double kSameNoise = 1.1;

/// Times: what is so much above the usual stands out of it: a deviation is of other noise, a peak of a
/// spectrum is none by chance.
constexpr double kLouder = 2;

/// Times: so much calmer sites say nothing of a place, and a cloud with such a tenth is not evenly noisy.
constexpr double kMuchLouder = 3;

/// Of what sheets, rows, waves or noise have: so little is none. Of what is alike in a row the next one of a
/// laser's rings has 0.1 and less, of waves of 7 and 8 points 0.6.
inline constexpr double kLittle = 0.25;

/// Of what scatters without a window: the narrowest window that is tried.
constexpr double kNarrowestWindow = 0.125;

}  // namespace rfsmooth::rfs_mesh
