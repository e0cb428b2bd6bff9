/// The solid that a front bounds, if it bounds one.
///
/// An advancing front leaves slits, welds and specks where points lie badly, and one sheet where noise has
/// merged the two sides of a thin wall. Its triangles are facets of the Delaunay tetrahedra of the points.
/// Each tetrahedron is called inside or outside so that
///
///     sum over facets between inside and outside of cost
///     + sum over the front's facets of area x (sides that disagree)
///     + sum over the points of 10 x mean area of a point x (ends of the normal that disagree)
///
/// is least. cost = 0.4 x the longest edge squared of a facet that is not the front's (about the area of an
/// even triangle, far more of a long one), 0.02 x area of one that is; the ends of a normal are the
/// tetrahedra at its point that lie behind it and before it: inside and outside. A minimum cut (Boykov and
/// Kolmogorov 2004), as Labatut, Pons and Keriven 2009 ("Robust and efficient surface reconstruction from
/// range data") use it with rays in the place of the front and the normals. The boundary of the inside is
/// closed by construction; of a merged wall the tetrahedra between its points are inside.
#pragma once

#include <vector>

#include <rfsmooth/context.h>
#include <rfsmooth/mesh.h>

#include "pipeline/adapters/cgal/front_types.h"

namespace rfsmooth::cgal {

/// A face of the front: its corners, oriented so that their right-hand side is outside, and the facet.
struct FrontFace {
  Face corners;
  Delaunay::Facet facet;
};

/// What the front bounds.
struct Solid {
  std::vector<Face> faces;  ///< its boundary, closed; right-hand side outside; may touch itself
  double kept = 0;          ///< area of its faces that are the front's, as a share of the front's area
  double disagreeing = 0;   ///< area of its faces that look against their points' normals, as a share of all
  double widest_gap = 0;    ///< area of the largest piece made of faces that reach farther than `longest`
};

/// `points`, `normals`: n x 3, what the ids of the vertices mean, unit, outward. `longest`: world units.
/// O(n^2) at worst, about linear on surfaces; 1.1 kB a point.
Solid solid_of(const Delaunay& tetrahedra, const Positions& points, const Positions& normals,
               const std::vector<FrontFace>& front, double longest, const Context& context);

}  // namespace rfsmooth::cgal
