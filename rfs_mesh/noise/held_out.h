/// How far points lie off a surface that others show: an upper bound of the noise.
///
/// A fit and what scatters about it cannot tell one sheet with much noise from several with little, or from
/// features as small as the noise: all fill the same slab. What tells them apart is whether a surface through
/// some of the points foretells where others are. A fifth of the points is held out; through the rest go
/// quadrics that neighbours share (local_surface.h), of m points each, and every point of the rest has a
/// shadow q_j on them with a normal n_j. A held out point x is then found with the density
///
///     p(x | m, s) ~ sum_j g(n_j . (x - q_j), s) g(|tangential part of x - q_j|, h) / s,
///
/// g(d, s) = exp(-d^2 / 2 s^2), h the spacing; the shadows keep the noise that the points have along the
/// surface. For each m = 16, 24, 36, ... whose balls are not much narrower than s, the best s is found.
/// Points that were not fitted cannot draw the surface after them, so the m that makes them likeliest is that
/// of the quadrics which follow it best, and s^2 there is the variance of the noise and of the surface's own
/// error: in expectation s is no less than the noise. Of all m as likely as the best, within half a standard
/// error of the difference, the widest counts, for its surface has the least error of its own.
///
/// Source: likelihood cross-validation (Stone 1974; Silverman 1986, 3.4.4), with a density about a surface.
#pragma once

#include <optional>

#include "rfs_mesh/search/neighbors.h"

namespace rfsmooth::rfs_mesh {

/// The bound, world units, of noise that was read as `sigma` > 0 and may be less; nothing where no
/// ball is wide enough for that. It looks at 20,000 of the points at most: O(1) for more, about a tenth of a
/// second. Parallel, deterministic. Thread safe.
std::optional<double> held_out_bound(const SpatialIndex& index, double sigma, const Context& context);

}  // namespace rfsmooth::rfs_mesh
