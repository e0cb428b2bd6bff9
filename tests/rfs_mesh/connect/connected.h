/// Clouds connected with the defaults, and how much of two meshes is the same.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include <rfsmooth/connect.h>

namespace rfsmooth::test {

inline Connection connected(const Positions& points, int threads = 0) {
  Context context;
  context.threads = threads;
  return connect(points, ConnectOptions{}, context).value();
}

inline double share_in_common(const std::vector<Face>& a, const std::vector<Face>& b) {
  const auto sorted = [](std::vector<Face> faces) {
    for (Face& f : faces) std::sort(f.begin(), f.end());
    std::sort(faces.begin(), faces.end());
    return faces;
  };
  const auto x = sorted(a), y = sorted(b);
  std::vector<Face> both;
  std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both));
  return double(both.size()) / double(std::max(x.size(), y.size()));
}

}  // namespace rfsmooth::test
