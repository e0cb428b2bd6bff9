#include "clouds/scanner/room.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "clouds/shapes/random.h"
#include "rfs_mesh/points.h"
#include "rfs_mesh/search/neighbors.h"

using namespace rfsmooth;
using namespace rfsmooth::clouds;
using Eigen::Vector3d;

namespace {

/// By its name, which the test's own has.
class EveryRoom : public testing::TestWithParam<std::string> {
 protected:
  const Room& room_ = GetParam() == "hall" ? hall() : corner();
};
INSTANTIATE_TEST_SUITE_P(Rooms, EveryRoom, testing::Values("hall", "corner"),
                         [](const auto& test) { return test.param; });

/// Calls add(a, b) at a grid over a rectangle, its lines at most `step` apart, its rim included.
template <class Add>
void over_grid(double low_a, double high_a, double low_b, double high_b, double step, Add&& add) {
  const int na = std::max(1, int(std::ceil((high_a - low_a) / step)));
  const int nb = std::max(1, int(std::ceil((high_b - low_b) / step)));
  for (int i = 0; i <= na; ++i)
    for (int j = 0; j <= nb; ++j) add(low_a + (high_a - low_a) * i / na, low_b + (high_b - low_b) * j / nb);
}

/// Points all over the surface, no place of it farther than `step` from one; denser where it is round, so
/// that they tell distances from afar as well.
Positions cover(const Room& room, double step) {
  const auto step_on = [&](double radius) { return std::min(step, radius / 10); };
  Positions points;
  for (const Box& box : room.boxes)
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {box.low[axis], box.high[axis]}) {
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        over_grid(box.low[a], box.high[a], box.low[b], box.high[b], step, [&](double at_a, double at_b) {
          Vector3d p;
          p[axis] = side;
          p[a] = at_a;
          p[b] = at_b;
          points.push_back(p);
        });
      }
  for (const Pillar& pillar : room.pillars)
    over_grid(0, 2 * M_PI * pillar.radius, pillar.low, pillar.high, step_on(pillar.radius),
              [&](double around, double along) {
                Vector3d p = pillar.centre;
                p[(pillar.axis + 1) % 3] += pillar.radius * std::cos(around / pillar.radius);
                p[(pillar.axis + 2) % 3] += pillar.radius * std::sin(around / pillar.radius);
                p[pillar.axis] = along;
                points.push_back(p);
              });
  for (const Ball& ball : room.balls)
    over_grid(0, M_PI * ball.radius, 0, 2 * M_PI * ball.radius, step_on(ball.radius),
              [&](double down, double around) {
                const double theta = down / ball.radius, phi = around / ball.radius;
                points.push_back(ball.centre + ball.radius * Vector3d(std::sin(theta) * std::cos(phi),
                                                                      std::sin(theta) * std::sin(phi),
                                                                      std::cos(theta)));
              });
  return points;
}

TEST_P(EveryRoom, DistanceIsThatToTheNearestOfPointsAllOverTheSurface) {
  constexpr double kStep = 0.03;
  const Positions surface = cover(room_, kStep);
  for (std::size_t i = 0; i < surface.size(); i += 97) EXPECT_NEAR(distance(room_, surface[i]), 0, 1e-12);
  const rfs_mesh::SpatialIndex index(surface, {});
  std::vector<rfs_mesh::Neighbor> near;
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    // Half of them anywhere, half of them near the surface, where the parts meet, too.
    Vector3d p = surface[random.bits() % surface.size()] + 0.1 * random.normal3();
    if (i % 2 == 0) p = random.in_box({-13, -10, -3}, {13, 10, 5});
    index.nearest(p, 1, near);
    const double nearest = std::sqrt(near[0].squared_distance), exact = distance(room_, p);
    EXPECT_LE(exact, nearest + 1e-12) << p.transpose();
    // A point of the grid is at most `step` beside the nearest point of the surface.
    EXPECT_GE(exact, nearest - kStep) << p.transpose();
    if (exact > 1) {
      EXPECT_GE(exact, nearest - kStep * kStep) << p.transpose();
    }
  }
}

TEST_P(EveryRoom, RaysEndOnTheSurfaceAndMeetNothingBefore) {
  Random random(4);
  int ended = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d ray = random.uniform(0.5, 2) * random.direction();
    const double t = meet(room_, ray);
    const double reach = std::min(t, 30.0);
    if (!std::isinf(t)) {
      ++ended;
      EXPECT_LT(distance(room_, t * ray), 1e-8);
    }
    // Where the surface is so far that a step cannot pass it, the ray has not met it.
    for (double s = 0; s < reach;) {
      const double clear = distance(room_, s * ray) / ray.norm();
      if (clear < 1e-6) {
        EXPECT_NEAR(s, t, 1e-3) << ray.transpose();
        break;
      }
      s += clear;
    }
  }
  EXPECT_GT(ended, 1000);
}

TEST(Room, DistancesThatOneSeesAtAGlance) {
  EXPECT_NEAR(distance(hall(), {10, -7, 0}), 1.5, 1e-12);           // over the floor
  EXPECT_NEAR(distance(hall(), {4, 2, 0.5}), 0.2, 1e-12);           // over the box
  EXPECT_NEAR(distance(hall(), {4, 2, 0.2}), 0.1, 1e-12);           // inside it
  EXPECT_NEAR(distance(hall(), {5.3, 3.4, 0}), 0.5, 1e-12);         // beside an edge of it
  EXPECT_NEAR(distance(hall(), {-4, 2.5, 0}), 0.1, 1e-12);          // beside a pillar
  EXPECT_NEAR(distance(hall(), {12.3, 9.4, 0}), 0.5, 1e-12);        // outside, before a corner of the walls
  EXPECT_NEAR(distance(corner(), {-0.5, 0.75, 1.6}), 0.15, 1e-12);  // before the ball
  EXPECT_NEAR(meet(hall(), {0, 0, -3}), 0.5, 1e-12);
  EXPECT_TRUE(std::isinf(meet(hall(), {0, 0, 1})));  // no ceiling
  EXPECT_NEAR(meet(corner(), {0, 0, 1}), 3.2, 1e-12);
  EXPECT_NEAR(meet(corner(), {-0.5, 0.75, 2}), 1 - 0.25 / std::sqrt(0.25 + 0.5625 + 4), 1e-12);
}

// The legs reach from the floor to the top, and the top is on them.
TEST(Room, TablesStandOnTheFloor) {
  for (const Room* room : {&hall(), &corner()}) {
    const std::size_t n = room->pillars.size();
    ASSERT_GE(n, 4u);
    const Box& top = room->boxes.back();
    for (std::size_t i = n - 4; i < n; ++i) {
      const Pillar& leg = room->pillars[i];
      const bool upward = room == &hall();
      EXPECT_EQ(upward ? leg.low : leg.high, upward ? -1.5 : 1);
      EXPECT_EQ(upward ? leg.high : leg.low, upward ? top.low[2] : top.high[1]);
      for (int axis = 0; axis < 3; ++axis) {
        if (axis == leg.axis) continue;
        EXPECT_GT(leg.centre[axis] - leg.radius, top.low[axis]);
        EXPECT_LT(leg.centre[axis] + leg.radius, top.high[axis]);
      }
    }
  }
}

}  // namespace
