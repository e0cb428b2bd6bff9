/// Shape that is louder than the noise: trees, bushes and the many small things of a street before a spinning
/// laser scatter about any quadric, and from place to place as evenly as noise does.
///
/// Noise shows itself: from some number of points on more of them scatter hardly more (NoiseSites::told), or
/// their residuals are normal (plain), and they lie in one plane (turned). Where sites show a tenth of the
/// surface to be so, what is three times as loud is shape if less than a quarter of the loud ones around it
/// show noise and a tenth of them or more have no plane. Of a cloud that shows less for sure, as of bushes
/// alone, nothing is known. Thread safe: no state is kept.
#pragma once

#include "rfs_mesh/noise/sites/noise_sites.h"

namespace rfsmooth::rfs_mesh {

/// Silences these sites: they do not speak, have the noise that others show for sure, and what they showed is
/// entered as `volume`. O(n log n) of the sites. Deterministic.
void silence_loud_shape(NoiseSites& sites, const Context& context);

}  // namespace rfsmooth::rfs_mesh
