/// Noise that neighbours share around some sites of a cloud, other than all of it has (shared_noise.h): the
/// rings of a laser that are each a little off, where they are near each other.
///
/// Around a site the scatter s(m) about a quadric stops growing where the neighbourhood is wider than such
/// noise reaches. Of the m from the narrowest on whose ball holds the slab of noisy points, the first counts
/// for which
///
/// - the ball holds the slab,
/// - s(2 m) has grown at all: 1.26 times from the narrowest, or 1.1 times where points err alike along rows,
///   of which a narrow ball, too, sees several,
/// - it has stopped: s(4 m) <= 1.26 s(m). (Shape that a quadric does not follow makes it grow 8 times, ground
///   1.4 times and more),
/// - the planes of 4 m points are those of m, as they are of no trees and not of the things of a street,
/// - the nearest points err together,
/// - and the residuals at 2 m are neither of two sheets nor of waves in rows nor of stones.
///
/// Then s(2 m) is noise, all of it. Of rows that the narrowest balls see already it is more, for wider balls
/// have more of them: 2 s^2(4 m) - s^2(m).
///
/// Of rows that each err by themselves, and are no steps of depths, where the next tells little of one
/// (SignsOfSharing::err_row_by_row), neither flatness nor a scatter that grows on is asked for or counts
/// against them, since a quadric follows the first few; only from 2 m to 4 m it must grow less than shape
/// does. k follows from what the narrower neighbourhoods see (points_sharing).
///
/// Nothing is found where s^2 grew 2.38 times from some narrower m to its double: bumps have a size, too,
/// beyond which they do not grow. Fits that scatter twice as far as what is typical around the site say
/// nothing, for they cross edges. Less than a tenth of the sites are not believed: scales of a statue.
#pragma once

#include <vector>

#include "rfs_mesh/noise/sites/views/open_fits.h"

namespace rfsmooth::rfs_mesh {

/// Raises `shared` and `floor` and sets `told` there, but where two sheets are seen. O(sites).
/// Parallel, deterministic. \param open from kNeighbourhood points on, each of twice as many
void find_shared_around(const SiteGroups& groups, const std::vector<OpenFits>& open,
                        std::vector<SiteView>& views, const Context& context);

}  // namespace rfsmooth::rfs_mesh
