#include "tests/bench/quality/data/dataset.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>

#include <Eigen/Geometry>
#include <unistd.h>

#include "clouds/shapes/random.h"
#include "clouds/shapes/sampling.h"
#include "clouds/shapes/shapes.h"
#include "tests/bench/quality/data/closest.h"

namespace rfsmooth::bench {
namespace {

namespace fs = std::filesystem;

/// Part of every cached sample's name: change it when sampling or shapes change.
constexpr int kSampleVersion = 1;
constexpr std::uint64_t kSampleSeed = 20;

/// Surfaces of our own. Curved ones as facets far finer than any sampling here: within 1e-5 of the radius.
const std::map<std::string, std::function<Mesh()>>& solids() {
  static const std::map<std::string, std::function<Mesh()>> table = {
      {"cube", [] { return clouds::make_cube()->mesh(2); }},
      {"l-part", [] { return clouds::make_l_part()->mesh(2); }},
      {"sphere", [] { return clouds::make_sphere()->mesh(0.008); }},
      {"torus", [] { return clouds::make_torus()->mesh(0.005); }},
      {"plate", [] { return clouds::make_plate(0.2)->mesh(2); }},
  };
  return table;
}

Mesh read_off(const fs::path& file) {
  std::ifstream in(file);
  std::string magic;
  std::size_t vertices = 0, faces = 0, edges = 0;
  if (!(in >> magic >> vertices >> faces >> edges) || magic != "OFF")
    throw std::runtime_error(file.string() +
                             " is not there (Debian package libcgal-demo) or is not an OFF file");
  Mesh mesh;
  mesh.positions.resize(vertices);
  for (auto& p : mesh.positions) in >> p[0] >> p[1] >> p[2];
  for (std::size_t f = 0; f < faces; ++f) {
    std::size_t corners = 0;
    in >> corners;
    std::vector<Index> ids(corners);
    for (auto& id : ids) in >> id;
    for (std::size_t k = 2; k < corners; ++k) mesh.faces.push_back({ids[0], ids[k - 1], ids[k]});
    in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  if (!in) throw std::runtime_error(file.string() + " ends too early");
  return mesh;
}

std::shared_ptr<const Sample> normalised(const std::string& name, Mesh mesh, Positions points) {
  Eigen::Vector3d low = points.at(0), high = low;
  for (const auto& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d center = (low + high) / 2;
  double radius = 0;
  for (const auto& p : points) radius = std::max(radius, (p - center).norm());
  auto sample = std::make_shared<Sample>();
  sample->shape = name;
  for (auto& p : mesh.positions) p = (p - center) / radius;
  for (auto& p : points) p = (p - center) / radius;
  sample->mesh = std::move(mesh);
  sample->clean = std::move(points);
  sample->spacing = clouds::mean_spacing(sample->clean);
  return sample;
}

/// The unit vector along which the scanner that sees this point most squarely looks at it.
Eigen::Vector3d ray_through(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
  constexpr double kDistance = 3;
  Eigen::Vector3d best = Eigen::Vector3d::UnitZ();
  double most = -1;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-kDistance, kDistance}) {
      const Eigen::Vector3d ray = (p - side * Eigen::Vector3d::Unit(axis)).normalized();
      const double squareness = std::abs(ray.dot(normal));
      // The facing side only: a point is not seen through the body. The surface's orientation is not relied
      // on, the nearer viewpoint of the two on an axis is taken instead.
      if (p[axis] * side < 0) continue;
      if (squareness > most) {
        most = squareness;
        best = ray;
      }
    }
  return best;
}

std::uint64_t mixed(std::uint64_t seed, const std::string& text) {  // FNV-1a
  std::uint64_t h = 14695981039346656037ULL ^ seed;
  for (const char c : text) h = (h ^ std::uint64_t(static_cast<unsigned char>(c))) * 1099511628211ULL;
  return h;
}

}  // namespace

std::string Noise::name() const {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%s %g%%", kind == NoiseKind::ray ? "ray" : "gaussian",
                100 * sigma);
  std::string name = text.data();
  if (outliers > 0) {
    std::snprintf(text.data(), text.size(), " + %g%% outliers", 100 * outliers);
    name += text.data();
  }
  return name;
}

const std::vector<std::string>& shape_names() {
  static const std::vector<std::string> names = {"anchor_dense",
                                                 "rotor",
                                                 "ChineseDragon-10kv",
                                                 "armadillo",
                                                 "hand",
                                                 "femur",
                                                 "knot1",
                                                 "mannequin-devil",
                                                 "cube",
                                                 "l-part",
                                                 "sphere",
                                                 "torus",
                                                 "plate"};
  return names;
}

const std::vector<std::string>& sharp_shapes() {
  static const std::vector<std::string> names = {"cube", "l-part", "anchor_dense", "rotor"};
  return names;
}

Mesh load_shape(const std::string& shape) {
  const auto solid = solids().find(shape);
  if (solid != solids().end()) return solid->second();
  for (const auto& name : shape_names())
    if (name == shape) return read_off(fs::path(RFSMOOTH_BENCH_MESHES) / (shape + ".off"));
  if (fs::path(shape).extension() == ".off") return read_off(shape);
  throw std::invalid_argument("no shape is called \"" + shape + "\"");
}

std::shared_ptr<const Sample> make_sample(const std::string& name, const Mesh& mesh, std::size_t n) {
  return normalised(name, mesh, clouds::sample(mesh, n, kSampleSeed));
}

std::shared_ptr<const Sample> load_sample(const std::string& shape, std::size_t n, const fs::path& cache) {
  Mesh mesh = load_shape(shape);
  const bool from_elsewhere = fs::path(shape).extension() == ".off";  // may change under its name
  if (cache.empty() || from_elsewhere) return make_sample(fs::path(shape).stem().string(), mesh, n);
  const fs::path folder = cache / "samples";
  const fs::path file =
      folder / (shape + "-" + std::to_string(n) + "-v" + std::to_string(kSampleVersion) + ".xyz64");
  Positions points(n);
  const auto bytes = std::streamsize(n * sizeof(Eigen::Vector3d));
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(points.data()), bytes)) {
    points = clouds::sample(mesh, n, kSampleSeed);
    fs::create_directories(folder);
    const fs::path partial = file.string() + ".part" + std::to_string(getpid());
    std::ofstream(partial, std::ios::binary).write(reinterpret_cast<const char*>(points.data()), bytes);
    fs::rename(partial, file);
  }
  return normalised(shape, std::move(mesh), std::move(points));
}

Case make_case(std::shared_ptr<const Sample> sample, const Noise& noise, std::uint64_t seed) {
  Case result;
  result.name = sample->shape + " " + std::to_string(sample->clean.size()) + " " + noise.name();
  result.noise = noise;
  result.noisy = sample->clean;
  clouds::Random random(mixed(seed, result.name));
  if (noise.kind == NoiseKind::gaussian) {
    for (auto& p : result.noisy) p += noise.sigma * random.normal3();
  } else {
    const ClosestTree surface(sample->mesh);
    for (auto& p : result.noisy) {
      const auto& f = sample->mesh.faces[surface.nearest(p).primitive];
      const auto &a = sample->mesh.positions[f[0]], &b = sample->mesh.positions[f[1]],
                 &c = sample->mesh.positions[f[2]];
      p += noise.sigma * random.normal() * ray_through(p, (b - a).cross(c - a).normalized());
    }
  }
  Eigen::Vector3d low = sample->clean.at(0), high = low;
  for (const auto& p : sample->clean) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d center = (low + high) / 2, half = 1.1 * (high - low) / 2;
  const auto strays = std::size_t(std::lround(noise.outliers * double(sample->clean.size())));
  for (std::size_t i = 0; i < strays; ++i) {
    result.noisy.push_back(random.in_box(center - half, center + half));
  }
  result.truth = std::move(sample);
  return result;
}

fs::path default_cache() {
  return RFSMOOTH_BENCH_CACHE;
}

}  // namespace rfsmooth::bench
