#include "tests/bench/train/training_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "clouds/shapes/random.h"
#include "tests/bench/train/solid.h"

namespace rfsmooth::bench {

using clouds::Random;
using Eigen::Vector3d;

namespace {

/// A solid and the box around it.
struct Made {
  Solid solid;
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();

  void reach(const Vector3d& a, const Vector3d& b) {
    if (!solid) {
      low = a;
      high = a;
    }
    low = low.cwiseMin(a).cwiseMin(b);
    high = high.cwiseMax(a).cwiseMax(b);
  }
  void add_box(const Vector3d& a, const Vector3d& b, double rounding = 0) {
    reach(a, b);
    solid = united(std::move(solid), box(a, b, rounding));
  }
  void add_limb(const Vector3d& a, const Vector3d& b, double ra, double rb, double blend) {
    const Vector3d room = Vector3d::Constant(std::max(ra, rb));
    reach(a.cwiseMin(b) - room, a.cwiseMax(b) + room);
    solid = blend > 0 ? blended(std::move(solid), limb(a, b, ra, rb), blend)
                      : united(std::move(solid), limb(a, b, ra, rb));
  }
};

int whole(Random& random, int low, int high) {
  return low + int(random.uniform() * (high - low + 1));
}

Vector3d sides(Random& random, double low, double high) {
  return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

Made chair(Random& random) {
  Made made;
  const double w = random.uniform(.6, 1), d = random.uniform(.6, 1), h = random.uniform(.5, 1),
               t = random.uniform(.03, .1), leg = random.uniform(.03, .1), back = random.uniform(.5, 1),
               round = random.uniform() < .5 ? 0 : .4 * std::min(t, leg);
  made.add_box({0, 0, h}, {w, d, h + t}, round);
  for (const double x : {0.0, w - leg})
    for (const double y : {0.0, d - leg}) made.add_box({x, y, 0}, {x + leg, y + leg, h + t}, round);
  if (random.uniform() < .5) {
    made.add_box({0, 0, h}, {w, t, h + back}, round);
  } else {
    const int posts = whole(random, 2, 5);
    for (int k = 0; k < posts; ++k) {
      const double x = (w - leg) * k / (posts - 1);
      made.add_box({x, 0, h}, {x + leg, leg, h + back + leg}, round);
    }
    made.add_box({0, 0, h + back}, {w, leg, h + back + leg}, round);
  }
  if (random.uniform() < .5)
    for (const double y : {0.0, d - leg}) made.add_box({0, y, h / 2}, {w, y + leg, h / 2 + leg}, round);
  return made;
}

Made casting(Random& random) {
  Made made;
  const Vector3d size = sides(random, .5, 1.2);
  const double t = random.uniform(.03, .12);
  made.add_box({0, 0, 0}, {size[0], size[1], t});
  const int ribs = whole(random, 2, 5);
  for (int k = 0; k < ribs; ++k) {
    const int across = whole(random, 0, 1), along = 1 - across;
    Vector3d low = Vector3d::Zero(), high;
    low[across] = random.uniform(0, size[across] - t);
    high[across] = low[across] + t * random.uniform(.7, 1.5);
    high[along] = size[along] * random.uniform(.4, 1);
    high[2] = size[2] * random.uniform(.3, 1);
    made.add_box(low, high);
  }
  if (random.uniform() < .4) made.add_box({0, 0, size[2]}, {size[0], size[1], size[2] + t});
  for (int holes = whole(random, 0, 2); holes > 0; --holes) {
    const Vector3d at(random.uniform(.2, .8) * size[0], random.uniform(.2, .8) * size[1], -1);
    made.solid =
        without(std::move(made.solid), cylinder(at, at + Vector3d(0, 0, 3), random.uniform(.05, .15)));
  }
  return made;
}

/// Sheet metal: a plate with parallel fins on it, and perhaps a wall across them.
Made fins(Random& random) {
  Made made;
  const Vector3d size = sides(random, .5, 1.2);
  const double t = random.uniform(.025, .06);
  made.add_box({0, 0, 0}, {size[0], size[1], t});
  const int count = whole(random, 3, 8);
  for (int k = 0; k < count; ++k) {
    const double x = (size[0] - t) * k / (count - 1);
    made.add_box({x, 0, 0}, {x + t, size[1], size[2] * random.uniform(.4, .8)});
  }
  if (random.uniform() < .3) made.add_box({0, 0, 0}, {size[0], t, size[2]});
  return made;
}

Made open_box(Random& random) {
  Made made;
  const Vector3d size = sides(random, .4, 1.2);
  const double t = random.uniform(.03, .12);
  made.add_box({0, 0, 0}, size, random.uniform() < .5 ? 0 : .4 * t);
  made.solid =
      without(std::move(made.solid),
              box({t, t, t}, {size[0] - t, size[1] - t, size[2] + (random.uniform() < .8 ? 1 : -t)}));
  return made;
}

/// A part as computers draw them.
Made block(Random& random) {
  Made made;
  const int boxes = whole(random, 1, 4);
  const double fillet = random.uniform() < .4 ? random.uniform(.02, .15) : 0;
  for (int k = 0; k < boxes; ++k) {
    const Vector3d low = sides(random, 0, .6), high = low + sides(random, .2, .7);
    const double round = random.uniform() < .5 ? 0 : random.uniform(.01, .08);
    made.reach(low, high);
    made.solid = fillet > 0 ? blended(std::move(made.solid), box(low, high, round), fillet)
                            : united(std::move(made.solid), box(low, high, round));
  }
  const Vector3d middle = (made.low + made.high) / 2;
  for (int k = whole(random, 0, 3); k > 0; --k) {  // chamfers
    const Vector3d n = random.direction();
    const double reach = n.cwiseAbs().dot(made.high - middle);
    made.solid =
        without(std::move(made.solid), half_space(-n, -n.dot(middle) - random.uniform(.5, .9) * reach));
  }
  for (int k = whole(random, 0, 2); k > 0; --k) {
    const Vector3d n = Vector3d::Unit(whole(random, 0, 2)),
                   at = middle + random.uniform(0, .3) * random.direction();
    made.solid = without(std::move(made.solid), cylinder(at - 2 * n, at + 2 * n, random.uniform(.05, .2)));
  }
  return made;
}

Made rods(Random& random) {
  Made made;
  const int count = whole(random, 4, 9);
  Vector3d at = Vector3d::Zero();
  for (int k = 0; k < count; ++k) {
    const double r = random.uniform(.02, .1);
    const Vector3d to = random.uniform() < .3
                            ? Vector3d(.35 * (k % 3), .35 * double(k / 3), random.uniform(.4, 1.2))
                            : Vector3d(at + random.uniform(.3, .9) * random.direction());
    made.add_limb(at, to, r, r * random.uniform(.6, 1), 0);
    at = random.uniform() < .5 ? to : Vector3d((at + to) / 2);
  }
  return made;
}

/// A creature: a body, limbs with joints, ears and a tail.
Made body(Random& random) {
  Made made;
  const double girth = random.uniform(.12, .3);
  const Vector3d hip(0, 0, 0), chest(random.uniform(.3, .7), 0, random.uniform(-.1, .2));
  made.add_limb(hip, chest, girth, girth * random.uniform(.7, 1.2), 0);
  const Vector3d head = chest + Vector3d(random.uniform(.15, .4), 0, random.uniform(.1, .5));
  const double skull = girth * random.uniform(.4, .8);
  made.add_limb(chest, head, girth * random.uniform(.4, .8), skull, .1);
  const auto jointed = [&](Vector3d at, Vector3d way, double r, int joints, double length) {
    for (int k = 0; k < joints; ++k) {
      const Vector3d to = at + length * way.normalized();
      const double end = r * random.uniform(.6, 1);
      made.add_limb(at, to, r, end, .06);
      at = to;
      r = end;
      way += .6 * random.normal3();
    }
  };
  const int pairs = whole(random, 1, 3);
  for (int k = 0; k < pairs; ++k) {
    const Vector3d from = hip + (pairs == 1 ? .5 : double(k) / (pairs - 1)) * (chest - hip);
    const double r = random.uniform(.03, .09), length = random.uniform(.15, .4);
    for (const double side : {-1.0, 1.0})
      jointed(from + Vector3d(0, .6 * side * girth, 0), {random.uniform(-.4, .4), .3 * side, -1}, r, 3,
              length);
  }
  for (const double side : {-1.0, 1.0})
    jointed(head + Vector3d(0, .5 * side * skull, 0), {random.uniform(-.5, .2), .5 * side, 1},
            random.uniform(.02, .06), 2, random.uniform(.1, .2));
  jointed(hip, {-1, 0, random.uniform(-.5, .5)}, random.uniform(.02, .07), whole(random, 2, 4), .25);
  return made;
}

/// A lump of balls.
Made lump(Random& random) {
  Made made;
  const int balls = whole(random, 2, 7);
  Vector3d at = Vector3d::Zero();
  for (int k = 0; k < balls; ++k) {
    const double r = random.uniform(.15, .45);
    const Vector3d to = at + random.uniform(.2, .5) * random.direction();
    made.add_limb(at, to, r, r * random.uniform(.6, 1.2), random.uniform(.05, .3));
    at = to;
  }
  return made;
}

/// The skin of a lump, cut open: bowls, masks, fins.
Made bowl(Random& random) {
  Made made = lump(random);
  made.solid = shell(std::move(made.solid), random.uniform(.03, .12));
  const Vector3d middle = (made.low + made.high) / 2, n = random.direction();
  made.solid = without(std::move(made.solid), half_space(-n, -n.dot(middle) - random.uniform(-.1, .3)));
  made.low.array() -= .06;
  made.high.array() += .06;
  return made;
}

/// A solid with scales, folds or grooves.
Made with_detail(Made made, Random& random) {
  const double wavelength = random.uniform(.06, .3), height = wavelength * random.uniform(.05, .25);
  Eigen::Matrix3d directions;
  for (int k = 0; k < 3; ++k) directions.row(k) = random.direction().transpose();
  made.solid = rippled(std::move(made.solid), height, wavelength, directions, random.uniform() < .5);
  made.low.array() -= height;
  made.high.array() += height;
  return made;
}

Made detailed_lump(Random& random) {
  return with_detail(lump(random), random);
}

Made detailed_body(Random& random) {
  return with_detail(body(random), random);
}

/// A hub, blades around it and perhaps a rim.
Made wheel(Random& random) {
  Made made;
  const Vector3d up = random.uniform(.05, .25) * Vector3d::UnitZ();
  const double hub = random.uniform(.1, .3), reach = random.uniform(.5, .8), t = random.uniform(.03, .1);
  made.solid = cylinder(-up, up, hub);
  const int blades = whole(random, 3, 9);
  const double pitch = random.uniform(-1.2, 1.2), width = random.uniform(.1, .3);
  for (int k = 0; k < blades; ++k) {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.rotate(Eigen::AngleAxisd(6.283185307179586 * k / blades, Vector3d::UnitZ()));
    motion.rotate(Eigen::AngleAxisd(pitch, Vector3d::UnitX()));
    made.solid = united(std::move(made.solid),
                        placed(box({0, -t / 2, -width / 2}, {reach, t / 2, width / 2}), motion));
  }
  if (random.uniform() < .5)
    made.solid = united(std::move(made.solid),
                        without(cylinder(-up, up, reach + t), cylinder(-2 * up, 2 * up, reach)));
  made.high = Vector3d(reach + t, reach + t, std::max(up[2], width));
  made.low = -made.high;
  return made;
}

/// Turns about z as one goes along it, and waves.
void bend(Random& random, Mesh& mesh) {
  const double turn = random.uniform(-1.2, 1.2), wave = random.uniform(0, .2);
  for (Vector3d& p : mesh.positions) {
    p = Eigen::AngleAxisd(turn * p[2], Vector3d::UnitZ()) * p;
    p += wave * Vector3d(std::sin(3 * p[1]), std::cos(2.5 * p[2]), std::sin(2 * p[0]));
  }
}

}  // namespace

TrainingShape make_training_shape(std::uint64_t number) {
  using Maker = Made (*)(Random&);
  constexpr std::array<std::pair<const char*, Maker>, 17> kMakers = {{{"chair", chair},
                                                                      {"body", body},
                                                                      {"casting", casting},
                                                                      {"block", block},
                                                                      {"body", body},
                                                                      {"bowl", bowl},
                                                                      {"rods", rods},
                                                                      {"lump", lump},
                                                                      {"casting", casting},
                                                                      {"block", block},
                                                                      {"body", body},
                                                                      {"box", open_box},
                                                                      {"lump", detailed_lump},
                                                                      {"wheel", wheel},
                                                                      {"body", detailed_body},
                                                                      {"wheel", wheel},
                                                                      {"fins", fins}}};
  constexpr double kCells = 110;  // along the longest side
  Random random(1000 + number);
  const auto& [kind, make] = kMakers[number % kMakers.size()];
  const Made made = make(random);
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), random.direction());
  TrainingShape shape{
      kind, surface_of(made.solid, made.low, made.high, (made.high - made.low).maxCoeff() / kCells)};
  if (random.uniform() < .5) bend(random, shape.mesh);
  for (Vector3d& p : shape.mesh.positions) p = turn * p;
  return shape;
}

}  // namespace rfsmooth::bench
