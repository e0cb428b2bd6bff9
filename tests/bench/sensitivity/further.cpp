#include "tests/bench/sensitivity/further.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include <rfsmooth/normals.h>
#ifdef RFSMOOTH_BENCH_WITH_CGAL
#include <rfsmooth/cgal/advancing_front.h>
#endif

#include "clouds/scanner/sensors.h"
#include "tests/bench/quality/data/measure.h"
#include "tests/bench/reconstruct/surface_error.h"
#include "tests/bench/sensitivity/angles.h"
#include "tests/bench/sensitivity/rows.h"

namespace rfsmooth::bench {
namespace {

constexpr const char* kKind = "further";
constexpr std::size_t kCrop = 5000;         // points of a sensor's cloud
constexpr std::size_t kCleanPoints = 6000;  // of a clean cloud whose normals are measured
constexpr double kVoxelSize = 0.03;         // metres: about seven pixels of the camera's wall
constexpr std::uint64_t kSensorSeed = 31;

/// \param times the law's noise, x what its row says.
void print_law(LawPlan plan, const std::string& law, double times, const std::string& shape,
               std::size_t points) {
  plan.times = times;
  const LawCase one = make_law_case(plan, law, shape, points);
  const Truth truth(one.truth);
  const Stopwatch watch;
  const OurResult ours = run_ours(one.cloud.measured, plan.ours, 1);
  const double seconds = watch.seconds(), unit = 1 / (one.truth->spacing * one.truth->spacing);
  print_row(kKind, shape, times_as_loud(law, times), seconds,
            {unit * truth.measure(ours.points, {}, {}).p2s});
}

/// Those of the cloud nearest to its sensor's middle ray, in their order.
Positions crop(const Positions& points, bool camera) {
  const Eigen::Vector3d middle = camera ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return middle.dot(points[a].normalized()) > middle.dot(points[b].normalized());
  });
  order.resize(std::min(kCrop, order.size()));
  std::sort(order.begin(), order.end());
  Positions near;
  for (const std::size_t i : order) near.emplace_back(points[i].cast<float>().cast<double>());
  return near;
}

/// The means of the points in each voxel, in the order of the voxels.
Positions voxel_means(const Positions& points) {
  std::map<std::array<int, 3>, std::pair<Eigen::Vector3d, double>> voxels;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Array3d at = (p / kVoxelSize).array().floor();
    auto& [sum, count] =
        voxels.try_emplace({int(at.x()), int(at.y()), int(at.z())}, Eigen::Vector3d::Zero(), 0.0)
            .first->second;
    sum += p;
    ++count;
  }
  Positions means;
  for (const auto& [voxel, of_it] : voxels) means.push_back(of_it.first / of_it.second);
  return means;
}

/// What looks from the room's inside at the surface nearest to p: its normal, by differences of the distance.
Eigen::Vector3d normal_of(const clouds::Room& room, const Eigen::Vector3d& p) {
  constexpr double kBefore = 0.005, kStep = 1e-4;  // metres
  Eigen::Vector3d at = p;
  const double off = clouds::distance(room, p);
  at -= (off + kBefore) * p.normalized();  // the sensor is at the origin
  Eigen::Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
    gradient[axis] = clouds::distance(room, at + step) - clouds::distance(room, at - step);
  }
  return gradient.normalized();
}

/// Of a sensor's points as it saw them, towards it.
void print_sensor_normals(const char* name) {
  const clouds::Sensor& sensor = *clouds::find_sensor(name);
  const Positions points = crop(clouds::look(sensor, kSensorSeed).measured, sensor.camera);
  NormalsOptions options;
  options.viewpoint = Eigen::Vector3d::Zero();
  Positions truth;
  for (const Eigen::Vector3d& p : points) truth.push_back(normal_of(clouds::room_of(sensor), p));
  const Angles angles = angles_of_normals(points, options, truth);
  print_row(kKind, name, "normals", angles.seconds, {angles.mean});
}

void print_cloud_of_room(const LawPlan& plan, const clouds::Sensor& sensor, const std::string& cloud,
                         const Positions& measured) {
  const clouds::Room& room = clouds::room_of(sensor);
  const Stopwatch watch;
  const OurResult ours = run_ours(measured, plan.ours, 1);
  const double seconds = watch.seconds();
  double squares = 0;
  for (const Eigen::Vector3d& p : ours.points) squares += std::pow(clouds::distance(room, p), 2);
  print_row(kKind, std::string(sensor.name), cloud, seconds, {squares / double(ours.points.size())});
}

void print_sensor(const LawPlan& plan, const char* name, double times) {
  const clouds::Sensor sensor = clouds::scaled(*clouds::find_sensor(name), times);
  const clouds::Sight sight = clouds::look(sensor, kSensorSeed);
  print_cloud_of_room(plan, sensor, times_as_loud("noise", times), crop(sight.measured, sensor.camera));
}

void print_voxels(const LawPlan& plan, const char* name) {
  const clouds::Sensor& sensor = *clouds::find_sensor(name);
  const clouds::Sight sight = clouds::look(sensor, kSensorSeed);
  print_cloud_of_room(plan, sensor, "voxels", crop(voxel_means(sight.measured), sensor.camera));
}

/// Three squares above each other, four standard deviations of their noise apart.
void print_stack(const LawPlan& plan) {
  constexpr double kNoise = 0.02;  // of the side: about two spacings
  constexpr int kSheets = 3;
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal(0, kNoise);
  std::uniform_real_distribution<double> uniform;
  Positions truth(kCrop), measured(kCrop);
  for (std::size_t i = 0; i < kCrop; ++i) {
    const double x = uniform(engine), y = uniform(engine), sheet = std::floor(kSheets * uniform(engine));
    truth[i] = {x, y, 4 * kNoise * sheet};
    for (int axis = 0; axis < 3; ++axis) measured[i][axis] = truth[i][axis] + normal(engine);
  }
  const Stopwatch watch;
  const OurResult ours = run_ours(measured, plan.ours, 1);
  const double seconds = watch.seconds();
  double squares = 0;
  for (std::size_t i = 0; i < kCrop; ++i) squares += std::pow(ours.points[i].z() - truth[i].z(), 2);
  print_row(kKind, "stack", "white", seconds, {squares / double(kCrop) / (kNoise * kNoise)});
}

void print_clean_normals(const LawPlan& plan, const std::string& shape) {
  const Truth truth(load_sample(shape, kCleanPoints, plan.cache));
  const Positions& points = truth.sample().clean;
  const Angles angles = angles_of_normals(points, {}, true_normals(truth, points));
  print_row(kKind, shape, "normals", angles.seconds, {angles.mean});
}

#ifdef RFSMOOTH_BENCH_WITH_CGAL
void print_surface(LawPlan plan, const std::string& shape, std::size_t points) {
  constexpr std::size_t kSamples = 20000;
  plan.times = 3;
  const LawCase one = make_law_case(plan, "white", shape, points);
  const auto* xyz = one.cloud.measured.data()->data();
  Context context;
  context.threads = 1;
  const Stopwatch watch;
  const auto made =
      reconstruct({xyz, xyz + 3 * one.cloud.measured.size()}, {}, cgal::advancing_front_method(), context);
  if (!made.ok()) throw std::runtime_error(made.error().message);
  const double seconds = watch.seconds(), unit = 1 / (one.truth->spacing * one.truth->spacing);
  print_row(kKind, shape, "surface", seconds,
            {unit * surface_error(made.value().mesh, one.truth->mesh, kSamples, context).both()});
}
#endif

/// The first two.
std::vector<std::string> some_shapes(const LawPlan& plan) {
  std::vector<std::string> some = plan.shapes;
  some.resize(std::min(std::size_t(2), some.size()));
  return some;
}

}  // namespace

void print_further(const LawPlan& plan, std::size_t points) {
  const std::vector<std::pair<const char*, double>> laws = {
      {"rings", 1}, {"steps4", 1}, {"scans", 1}, {"correlated30", 1}, {"mixed", 1}, {"white", 0.1}};
  for (std::size_t k = 0; k < laws.size(); ++k)  // one shape each
    print_law(plan, laws[k].first, laws[k].second, plan.shapes[k % plan.shapes.size()], points);
  for (const char* const sensor : {"rings16", "rings64", "half_degree_2mm", "kinect", "stereo_small"})
    print_sensor(plan, sensor, 1);
  print_sensor(plan, "kinect", 0.3);
  print_voxels(plan, "time_of_flight");
  print_stack(plan);
}

void print_further_normals(const LawPlan& plan) {
  for (const char* const sensor : {"rings64", "stereo_small"}) print_sensor_normals(sensor);
  for (const std::string& shape : some_shapes(plan)) print_clean_normals(plan, shape);
}

#ifdef RFSMOOTH_BENCH_WITH_CGAL
void print_surfaces(const LawPlan& plan, std::size_t points) {
  for (const std::string& shape : some_shapes(plan)) print_surface(plan, shape, points);
}
#else
void print_surfaces(const LawPlan&, std::size_t) {}
#endif

}  // namespace rfsmooth::bench
