/// What holds of every connection, whatever the points.
#pragma once

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rfsmooth/connect.h>

#include "tests/support/edge_census.h"
#include "tests/support/kruskal.h"

namespace rfsmooth::test {

inline void expect_sound(const Connection& c, std::size_t n) {
  EXPECT_EQ(c.mesh.positions.size(), n);
  EXPECT_TRUE(rfsmooth::check(c.mesh).empty());
  EXPECT_EQ(c.emst.size(), n == 0 ? 0 : n - 1);
  EXPECT_EQ(c.surfaces.size(), n);
  EXPECT_TRUE(std::is_sorted(c.sdg.begin(), c.sdg.end()));
  const EdgeCensus census = edge_census(c.mesh);
  EXPECT_EQ(census.crowded, 0u) << "an edge has more than two faces";
  EXPECT_EQ(census.loose, c.mesh.loose_edges.size()) << "an edge without a face is not listed as loose";
  EXPECT_EQ(census.faceless, c.faceless);
  for (const LocalSurface& s : c.surfaces) {
    ASSERT_TRUE(s.normal.allFinite() && s.shadow.allFinite() && std::isfinite(s.residual));
    ASSERT_NEAR(s.normal.norm(), 1, 1e-9);
  }
}

/// Whether the edges join all n vertices.
inline bool joins_all(std::size_t n, const std::vector<Edge>& edges, const std::vector<Edge>& more = {}) {
  Components components(n);
  for (const auto* list : {&edges, &more})
    for (const Edge& e : *list) components.join(e[0], e[1]);
  return components.count() <= 1;
}

inline double total_length(const Positions& points, const std::vector<Edge>& edges) {
  double sum = 0;
  for (const Edge& e : edges) sum += (points[e[0]] - points[e[1]]).norm();
  return sum;
}

}  // namespace rfsmooth::test
