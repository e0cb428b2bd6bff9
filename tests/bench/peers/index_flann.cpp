#include <vector>

#include <flann/flann.hpp>

#include "tests/bench/peers/index_peers.h"

namespace rfsmooth::bench::peers {

namespace {

class Flann : public NeighborIndex {
 public:
  Flann(const double* xyz, std::size_t n)
      : data_(const_cast<double*>(xyz), n, 3), index_(data_, flann::KDTreeSingleIndexParams(15)) {
    index_.buildIndex();
  }
  void nearest(std::size_t begin, std::size_t end, int k, std::uint32_t* rows) const override {
    std::vector<int> ids((end - begin) * std::size_t(k));
    std::vector<double> distances(ids.size());
    flann::Matrix<double> queries(data_[begin], end - begin, 3);
    flann::Matrix<int> found(ids.data(), end - begin, std::size_t(k));
    flann::Matrix<double> found_distances(distances.data(), end - begin, std::size_t(k));
    flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED, 0, true);
    exact.cores = 1;  // the caller's loop is the parallel one
    index_.knnSearch(queries, found, found_distances, std::size_t(k), exact);
    for (std::size_t i = 0; i < ids.size(); ++i) rows[begin * std::size_t(k) + i] = std::uint32_t(ids[i]);
  }

 private:
  flann::Matrix<double> data_;
  flann::Index<flann::L2_Simple<double>> index_;
};

}  // namespace

std::unique_ptr<NeighborIndex> flann_index(const double* xyz, std::size_t n) {
  return std::make_unique<Flann>(xyz, n);
}

}  // namespace rfsmooth::bench::peers
