/// The solid that a front bounds, if it bounds one.
///
/// An advancing front leaves slits, welds and specks where points lie badly, and a single sheet where noise
/// has merged the two sides of a thin wall. Its triangles are facets of the Delaunay tetrahedra of the
/// points. Each tetrahedron is labelled inside or outside so as to minimise
///
///     sum over facets between inside and outside of cost
///     + sum over the front's facets of area x (sides that disagree)
///     + sum over the points of 10 x mean area of a point x (ends of the normal that disagree)
///
/// cost is 0.02 x area for a facet of the front, and 0.4 x the longest edge squared for any other (about the
/// area of an even triangle, far more of a long one). The ends of a normal are the tetrahedra at its point
/// that lie behind it (should be inside) and before it (should be outside). A minimum cut (Boykov and
/// Kolmogorov 2004) finds the labels; Labatut, Pons and Keriven 2009 ("Robust and efficient surface
/// reconstruction from range data") use it with rays in the place of the front and the normals. The boundary
/// of the inside is closed by construction. Of a merged wall the tetrahedra between its points are inside.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "pipeline/adapters/cgal/front_types.h"

namespace rfsmooth::cgal {

/// A face of the front: its corners, outward by the right-hand rule, and the facet.
struct FrontFace {
  Face corners;
  Delaunay::Facet facet;
};

/// What the front bounds.
struct Solid {
  std::vector<Face> faces;  ///< its boundary: closed, oriented as FrontFace; may touch itself
  double kept = 0;          ///< area of its faces that are the front's, as a share of the front's area
  double disagreeing = 0;   ///< area of its faces that face against their points' normals, share of all
  double widest_gap = 0;    ///< area of the largest piece made of faces that reach farther than `longest`
};

/// `points` and unit outward `normals` (n x 3) are indexed by the ids of the vertices. `longest`: world
/// units. O(n^2) at worst, about linear on surfaces; 1.1 kB a point.
Solid solid_of(const Delaunay& tetrahedra, const Positions& points, const Positions& normals,
               const std::vector<FrontFace>& front, double longest, const Context& context);

}  // namespace rfsmooth::cgal
