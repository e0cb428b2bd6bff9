/// Surface reconstruction by CGAL's advancing front (Cohen-Steiner and Da 2004): a Delaunay-based surface
/// through the points themselves. The package is GPL-3.0-or-later: linking rfsmooth::cgal makes the binary
/// so.
///
/// Differs from the paper: where the front all but bounds a solid, the boundary of that solid is given back:
/// slits and welds of the front are mended with other facets of the same Delaunay tetrahedra, walls that
/// noise has merged into one sheet get their two sides back, and a closed shape comes out closed. Not so if
/// the solid's surface looks against the normals, as both sides of an open sheet cannot but do, or spans an
/// opening with faces beyond the longest edge. Differs from CGAL: candidates of one priority wait in the
/// order of the points, not of addresses in memory, so the same points give the same surface.
#pragma once

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>
#include <rfsmooth/reconstruct.h>
#include <rfsmooth/result.h>

namespace rfsmooth::cgal {

/// The vertices are the points, in order (those the surface does not reach have no face), and after them
/// copies of those at which the solid touches itself; faces are oriented consistently within each piece.
/// `normals`: n x 3, on one side: pieces are turned to agree with them, and a front that all but bounds a
/// solid is closed; empty: neither. Faces with an edge longer than `longest_edge` (world units; 0 = no
/// limit), which lie across gaps, are dropped. Errors: no_usable_points if there is no surface,
/// out_of_memory; cancelled only before CGAL begins and behind it. \throw std::invalid_argument if the
/// normals are neither none nor one per point. O(n log n), mostly one thread, the same bytes every time.
/// Thread safe: no state is kept.
Result<Mesh> advancing_front(const Positions& points, const Positions& normals, double longest_edge,
                             const Context& context);

/// The same as a method of rfsmooth/reconstruct.h.
SurfaceMethod advancing_front_method();

}  // namespace rfsmooth::cgal
