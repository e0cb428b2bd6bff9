/// CGAL's types behind the advancing front: for the .cpp files of this folder only.
#pragma once

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace rfsmooth::cgal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using FrontVertex = CGAL::Advancing_front_surface_reconstruction_vertex_base_3<Kernel>;
using FrontCell = CGAL::Advancing_front_surface_reconstruction_cell_base_3<Kernel>;
/// The vertices' id() is the index of their point.
using Delaunay =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<FrontVertex, FrontCell>>;

}  // namespace rfsmooth::cgal
