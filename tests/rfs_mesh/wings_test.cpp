#include "rfs_mesh/wings.h"

#include <map>
#include <random>

#include <gtest/gtest.h>

using namespace rfsmooth;
using namespace rfsmooth::rfs_mesh;

namespace {

using Edges = std::map<Index, std::vector<Index>>;

/// The same with a map.
Edges crowded(Index vertex, const std::vector<std::pair<Index, Index>>& sides) {
  Edges all, some;
  for (const auto& [end, face] : sides)
    if (end > vertex) all[end].push_back(face);
  for (const auto& [end, faces] : all)
    if (faces.size() > 2) some[end] = faces;
  return some;
}

TEST(Wings, FindsTheCrowdedEdgesOfOneVertexAfterTheOther) {
  std::mt19937_64 engine(1);
  Wings wings;
  for (const std::size_t faces : {0u, 1u, 3u, 10u, 32u, 33u, 100u, 5u, 12u}) {  // more than 64 wings and less
    for (Index vertex = 1000; vertex < 1100; ++vertex) {
      std::uniform_int_distribution<Index> near(vertex - 4, vertex + Index(faces / 2) + 2);
      std::vector<std::pair<Index, Index>> sides;
      for (Index f = 0; f < faces; ++f)
        for (int k = 0; k < 2; ++k) {
          Index end = near(engine);
          if (end == vertex) ++end;
          // Ends that meet in the hash table: a multiple of its size apart.
          sides.emplace_back(f % 3 == 0 ? end + 4096 * (f % 5) : end, f);
        }
      wings.reset(vertex, sides.size());
      for (const auto& [end, face] : sides) wings.add_if_above(end, face);
      Edges found;
      wings.for_each_crowded([&](Index end, const Index* first, std::size_t count) {
        EXPECT_TRUE(found.emplace(end, std::vector<Index>(first, first + count)).second);
      });
      EXPECT_EQ(found, crowded(vertex, sides)) << faces << " faces";
    }
  }
}

}  // namespace
