#include "clouds/scanner/room.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rfsmooth::clouds {

using Eigen::Vector3d;

namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// A top on four round legs that stand `inset` inside its edges and reach down to the floor, along `up`.
void add_table(Room& room, int up, const Box& top, double floor, double leg_radius) {
  constexpr double kInset = 0.08;
  room.boxes.push_back(top);
  const bool upward = floor < top.low[up];
  const int a = (up + 1) % 3, b = (up + 2) % 3;
  for (const bool far_a : {false, true})
    for (const bool far_b : {false, true}) {
      Vector3d foot = Vector3d::Zero();
      foot[a] = far_a ? top.high[a] - kInset : top.low[a] + kInset;
      foot[b] = far_b ? top.high[b] - kInset : top.low[b] + kInset;
      room.pillars.push_back(
          {up, foot, leg_radius, upward ? floor : top.high[up], upward ? top.low[up] : floor});
    }
}

Room make_hall() {
  constexpr double kFloor = -1.5, kTop = 4;
  Room room;
  room.boxes = {{{-12, -9, kFloor}, {12, 9, kFloor}},  // the floor
                {{-12, -9, kFloor}, {-12, 9, kTop}},   // four walls
                {{12, -9, kFloor}, {12, 9, kTop}},    {{-12, -9, kFloor}, {12, -9, kTop}},
                {{-12, 9, kFloor}, {12, 9, kTop}},    {{3, 1, kFloor}, {5, 3, 0.3}}};
  room.balls = {{{-3, -2, kFloor + 0.5}, 0.5}};
  room.pillars = {{2, {-4, 2, 0}, 0.4, kFloor, 2.5}, {2, {-2, -5, 0}, 0.15, kFloor, 2.5}};
  add_table(room, 2, {{1.2, -2.6, -0.78}, {2.8, -1.8, -0.75}}, kFloor, 0.03);
  return room;
}

Room make_corner() {
  constexpr double kFloor = 1, kTop = -1.5, kLeft = -1.5, kRight = 2, kBack = 3.2;
  Room room;
  room.boxes = {{{kLeft, kFloor, 0}, {kRight, kFloor, kBack}},
                {{kLeft, kTop, kBack}, {kRight, kFloor, kBack}},
                {{kLeft, kTop, 0}, {kLeft, kFloor, kBack}},
                {{0.2, 0.3, 1.8}, {0.9, kFloor, 2.4}}};
  room.balls = {{{-0.5, 0.75, 2}, 0.25}};
  room.pillars = {{1, {1.2, 0, 2.8}, 0.1, kTop, kFloor}};
  add_table(room, 1, {{-1.3, 0.27, 2.4}, {-0.6, 0.3, 2.9}}, kFloor, 0.02);
  return room;
}

/// Of the faces of a box, grown by what rounding needs for a ray not to pass between two of them.
double meet(const Box& box, const Vector3d& ray) {
  constexpr double kSeam = 1e-9;
  const auto within = [&](double at, int axis) {
    return at >= box.low[axis] - kSeam && at <= box.high[axis] + kSeam;
  };
  double nearest = kNowhere;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray[axis] == 0) continue;
    for (const double side : {box.low[axis], box.high[axis]}) {
      const double t = side / ray[axis];
      if (t <= 0 || t >= nearest) continue;
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      if (within(t * ray[a], a) && within(t * ray[b], b)) nearest = t;
    }
  }
  return nearest;
}

/// The first way that |t ray - centre| is the radius, outside of which the sensor is.
double meet_round(const Vector3d& ray, const Vector3d& centre, double radius) {
  const double a = ray.squaredNorm(), b = ray.dot(centre);
  const double inside = b * b - a * (centre.squaredNorm() - radius * radius);
  if (a == 0 || b <= 0 || inside < 0) return kNowhere;
  return (b - std::sqrt(inside)) / a;
}

double meet(const Pillar& pillar, const Vector3d& ray) {
  Vector3d flat = ray, centre = pillar.centre;
  flat[pillar.axis] = centre[pillar.axis] = 0;
  const double t = meet_round(flat, centre, pillar.radius);
  const double along = t * ray[pillar.axis];
  return along >= pillar.low && along <= pillar.high ? t : kNowhere;
}

double distance(const Box& box, const Vector3d& p) {
  const Vector3d outside = (box.low - p).cwiseMax(p - box.high);
  if (outside.maxCoeff() > 0) return outside.cwiseMax(0).norm();
  return -outside.maxCoeff();
}

double distance(const Pillar& pillar, const Vector3d& p) {
  Vector3d flat = p - pillar.centre;
  flat[pillar.axis] = 0;
  const double along = p[pillar.axis] - std::clamp(p[pillar.axis], pillar.low, pillar.high);
  return std::hypot(flat.norm() - pillar.radius, along);
}

}  // namespace

const Room& hall() {
  static const Room room = make_hall();
  return room;
}

const Room& corner() {
  static const Room room = make_corner();
  return room;
}

double meet(const Room& room, const Vector3d& ray) {
  double nearest = kNowhere;
  for (const Box& box : room.boxes) nearest = std::min(nearest, meet(box, ray));
  for (const Ball& ball : room.balls) nearest = std::min(nearest, meet_round(ray, ball.centre, ball.radius));
  for (const Pillar& pillar : room.pillars) nearest = std::min(nearest, meet(pillar, ray));
  return nearest;
}

double distance(const Room& room, const Vector3d& p) {
  double nearest = kNowhere;
  for (const Box& box : room.boxes) nearest = std::min(nearest, distance(box, p));
  for (const Ball& ball : room.balls)
    nearest = std::min(nearest, std::abs((p - ball.centre).norm() - ball.radius));
  for (const Pillar& pillar : room.pillars) nearest = std::min(nearest, distance(pillar, p));
  return nearest;
}

}  // namespace rfsmooth::clouds
