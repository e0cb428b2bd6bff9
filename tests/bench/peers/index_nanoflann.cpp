#include <vector>

#include <nanoflann.hpp>

#include "tests/bench/peers/index_peers.h"

namespace rfsmooth::bench::peers {

namespace {

struct Cloud {
  const double* xyz;
  std::size_t n;
  std::size_t kdtree_get_point_count() const { return n; }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return xyz[3 * i + axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

class Nanoflann : public NeighborIndex {
 public:
  Nanoflann(const double* xyz, std::size_t n) : cloud_{xyz, n}, index_(3, cloud_, {10}) {}
  void nearest(std::size_t begin, std::size_t end, int k, std::uint32_t* rows) const override {
    std::vector<double> distances(static_cast<std::size_t>(k));
    for (std::size_t i = begin; i < end; ++i)
      index_.knnSearch(cloud_.xyz + 3 * i, std::size_t(k), rows + i * std::size_t(k), distances.data());
  }

 private:
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>
      index_;
};

}  // namespace

std::unique_ptr<NeighborIndex> nanoflann_index(const double* xyz, std::size_t n) {
  return std::make_unique<Nanoflann>(xyz, n);
}

}  // namespace rfsmooth::bench::peers
