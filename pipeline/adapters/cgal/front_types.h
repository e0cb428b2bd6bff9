/// CGAL's types behind the advancing front: for the .cpp files of this folder only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <tuple>

#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace rfsmooth::cgal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// CGAL's vertex, except that candidates of equal priority are ordered by the points at their edge. CGAL
/// orders them by address, so its surface differs from run to run.
template <class Traits, class Base = CGAL::Triangulation_vertex_base_3<Traits>>
class OrderedVertex : public CGAL::Advancing_front_surface_reconstruction_vertex_base_3<Traits, Base> {
  using Front = CGAL::Advancing_front_surface_reconstruction_vertex_base_3<Traits, Base>;

 public:
  template <class Tds>
  struct Rebind_TDS {
    using Other = OrderedVertex<Traits, typename Base::template Rebind_TDS<Tds>::Other>;
  };
  using Front::Front;

  struct Radius_ptr_type {
    Radius_ptr_type(double priority, typename Front::IO_edge_type* edge) : first(priority), second(edge) {
      const auto& ends = edge->first.first;
      std::tie(low, high) =
          std::minmax({ends.first->vertex(ends.second)->id(), ends.first->vertex(ends.third)->id()});
    }
    bool operator<(const Radius_ptr_type& other) const {
      return std::tie(first, low, high) < std::tie(other.first, other.low, other.high);
    }
    double first;
    typename Front::IO_edge_type* second;
    std::size_t low = 0, high = 0;
  };
};

/// CGAL's cell, numbered in the order of creation. Cells are compared by this number, not by address.
template <class Traits, class Base = CGAL::Triangulation_cell_base_3<Traits>>
class NumberedCell : public CGAL::Advancing_front_surface_reconstruction_cell_base_3<Traits, Base> {
  using Front = CGAL::Advancing_front_surface_reconstruction_cell_base_3<Traits, Base>;

 public:
  template <class Tds>
  struct Rebind_TDS {
    using Other = NumberedCell<Traits, typename Base::template Rebind_TDS<Tds>::Other>;
  };
  using Front::Front;

  using Has_timestamp = CGAL::Tag_true;
  std::size_t time_stamp() const { return number_; }
  void set_time_stamp(std::size_t number) { number_ = number; }

 private:
  std::size_t number_ = std::size_t(-1);  // what CGAL gives a cell without a number
};

using FrontVertex = OrderedVertex<Kernel>;
using FrontCell = NumberedCell<Kernel>;
/// The vertices' id() is the index of their point.
using Delaunay =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<FrontVertex, FrontCell>>;

}  // namespace rfsmooth::cgal
