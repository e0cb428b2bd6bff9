/// The solid that a front bounds, if it bounds one.
///
/// An advancing front leaves slits, welds and specks where points lie badly. Its triangles are facets of the
/// Delaunay tetrahedra of the points. Each tetrahedron is called inside or outside so that
///
///     sum over facets between inside and outside of cost + sum over the front's facets of area x (sides that
///     disagree)
///
/// is least, cost = the longest edge squared of a facet that is not the front's, 0.02 x area of one that is:
/// a minimum cut (Boykov and Kolmogorov 2004), as Labatut, Pons and Keriven 2009 ("Robust and efficient
/// surface reconstruction from range data") use it with rays in the place of the front. The boundary of the
/// inside is closed by construction.
#pragma once

#include <vector>

#include "rfsmooth/cgal/front_types.h"
#include "rfsmooth/rfs_mesh/context.h"
#include "rfsmooth/rfs_mesh/mesh.h"

namespace rfsmooth::cgal {

/// A face of the front: its corners, oriented so that their right-hand side is outside, and the facet.
struct FrontFace {
  rfs_mesh::Face corners;
  Delaunay::Facet facet;
};

/// What the front bounds.
struct Solid {
  std::vector<rfs_mesh::Face> faces;  ///< its boundary, a closed manifold; right-hand side outside
  double kept = 0;      ///< area of its faces that are the front's, as a share of the front's area
  double invented = 0;  ///< area of the others, as the same share
};

/// `points`: n x 3, what the ids of the vertices mean. O(n^2) at worst, about linear on surfaces; 1.1 kB a
/// point.
Solid solid_of(const Delaunay& tetrahedra, const Positions& points, const std::vector<FrontFace>& front,
               const Context& context);

}  // namespace rfsmooth::cgal
