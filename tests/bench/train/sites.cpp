/// Writes what the learned step (smoothing/automatic/learned) is given at points of noisy clouds, and how far
/// the true surface is from there along the normal: what train.py learns from.
///
/// The file: four 32-bit numbers (format, even and odd features, targets), then for every point, in 32-bit
/// floats: the number of its cloud, the even features, the odd ones, and the squared distances to the
/// surface, in s^2, at kTargets places from -4 to 4 s along the normal.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>

#include <CLI/CLI.hpp>

#include "base/parallel.h"
#include "clouds/scanner/laws.h"
#include "clouds/shapes/sampling.h"
#include "rfs_mesh/connect/connect.h"
#include "rfs_mesh/points.h"
#include "smoothing/automatic/flow_auto.h"
#include "smoothing/automatic/learned/weights.h"
#include "tests/bench/quality/data/closest.h"
#include "tests/bench/quality/data/dataset.h"
#include "tests/bench/support/main.h"
#include "tests/bench/train/training_shapes.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::bench;
using smoothing::LearnedInput;

constexpr int kTargets = 33;
constexpr double kReach = 4;  // s

/// How a cloud is made of a shape.
struct Recipe {
  clouds::Law law;
  clouds::Sampling sampling = clouds::Sampling::poisson_disk;
  std::size_t points = 10000;
  double share = 0;                 ///< noise, of the shape's radius
  std::optional<double> disturbed;  ///< the noise is stated, wrong by this factor; empty: measured
};

Recipe make_recipe(std::uint64_t number) {
  clouds::Random random(5000000 + number);
  Recipe recipe;
  recipe.share = (random.uniform() < .4 ? random.uniform(.004, .014) : random.uniform(.01, .036));
  const double kind = random.uniform();
  if (kind > .6 && kind < .75) {
    recipe.law.along_ray = true;
    recipe.law.range_power = 2;
  } else if (kind > .75 && kind < .87) {
    recipe.law.loud_share = random.uniform(.02, .25);
    recipe.law.loud_times = random.uniform(2, 5);
    recipe.share *= .6;
  } else if (kind > .87) {
    recipe.law.range_power = random.uniform(2, 4);
  }
  const double spread = random.uniform();
  if (spread < .2) {
    recipe.sampling = clouds::Sampling::uniform;
  } else if (spread < .32) {
    recipe.law.spread = clouds::Spread::rings;
    recipe.law.ring_gap = std::pow(20, random.uniform());
    recipe.law.along_ray = true;
  }
  const double size = random.uniform();
  if (size < .32) {  // noise of many layers of points, where they make films of walls
    recipe.points = std::size_t(25000 * std::pow(2.6, random.uniform()));
    if (random.uniform() < .75) recipe.share = random.uniform(.012, .036);
  } else if (size < .55) {
    recipe.points = std::size_t(4000 * std::pow(15, random.uniform()));
  }
  if (random.uniform() < .5) recipe.disturbed = random.uniform(.85, 1.15);
  return recipe;
}

/// A cloud and the mesh of its surface, both of radius 1.
struct Cloud {
  std::shared_ptr<const Sample> truth;
  Positions measured;
  double sigma = 0;
};

Cloud make_cloud(const TrainingShape& shape, std::uint64_t number, Recipe recipe) {
  Sample sample;
  sample.mesh = shape.mesh;
  sample.clean = recipe.sampling == clouds::Sampling::uniform
                     ? clouds::sample(shape.mesh, recipe.points, number, recipe.sampling)
                     : clouds::spread(recipe.law, shape.mesh, recipe.points, number).points;
  const clouds::Frame frame = clouds::frame_of(sample.clean);
  for (auto* points : {&sample.clean, &sample.mesh.positions})
    for (auto& p : *points) p = (p - frame.centre) / frame.radius;
  sample.spacing = clouds::mean_spacing(sample.clean);
  recipe.law.sigma = recipe.share / sample.spacing;
  Cloud cloud;
  cloud.sigma = recipe.share;
  cloud.measured = clouds::add_noise(recipe.law, {sample.clean, {}}, sample.spacing, number).measured;
  cloud.truth = std::make_shared<Sample>(std::move(sample));
  return cloud;
}

LearnedInput input_of(const Cloud& cloud, const Recipe& recipe, const Context& context) {
  auto working = value_or_throw(
      rfs_mesh::make_working_cloud(cloud.measured.data()->data(), cloud.measured.size(), context));
  for (auto& p : working.points) p += working.origin;
  rfs_mesh::Wanted wanted;
  wanted.emst = wanted.tree = wanted.loose_edges = false;
  Mesh mesh = value_or_throw(rfs_mesh::connect(working.points, {}, wanted, context)).mesh;
  AutomaticOptions options;
  if (recipe.disturbed) options.noise = Length{*recipe.disturbed * cloud.sigma, false};
  LearnedInput input;
  smooth_automatically(mesh, options, context, smoothing::Connectivity::used_up, nullptr, &input);
  return input;
}

/// A share of the points, with their targets.
void write(std::uint64_t number, const Cloud& cloud, const LearnedInput& input, std::size_t wanted,
           const Context& context, std::ofstream& out) {
  using smoothing::Features;
  constexpr std::size_t kRow = 1 + Features::kEven + Features::kOdd + kTargets;
  const std::size_t n = input.point.size(), count = std::min(wanted, n);
  if (count == 0) return;
  const ClosestTree surface(cloud.truth->mesh);
  std::vector<float> rows(count * kRow);
  for_each_index(
      context, count,
      [&](std::size_t k) {
        const std::size_t i = k * n / count;
        float* to = rows.data() + k * kRow;
        *to++ = float(number);
        to = std::copy(input.features[i].even.begin(), input.features[i].even.end(), to);
        to = std::copy(input.features[i].odd.begin(), input.features[i].odd.end(), to);
        const double s = input.unit[i];
        for (int t = 0; t < kTargets; ++t) {
          const double height = kReach * (2.0 * t / (kTargets - 1) - 1) * s;
          *to++ = float(surface.nearest(input.place[i] + height * input.normal[i]).squared / (s * s));
        }
      },
      16);
  out.write(reinterpret_cast<const char*>(rows.data()), std::streamsize(rows.size() * sizeof(float))).flush();
}

int run(int argc, char** argv) {
  std::string file, shape;
  double share = 0.02;
  std::uint64_t first = 0, count = 300;
  std::size_t wanted = 1600;
  Context context;
  context.threads = 2;
  CLI::App app{"What the learned step is given, with the truth"};
  app.add_option("file", file, "where to")->required();
  app.add_option("--first", first, "number of the first cloud")->capture_default_str();
  app.add_option("--clouds", count, "how many")->capture_default_str();
  app.add_option("--sites", wanted, "points of a cloud")->capture_default_str();
  app.add_option("--threads", context.threads, "")->capture_default_str();
  app.add_option("--shape", shape,
                 "one cloud of this shape of the quality benchmark: to look at, not to learn from");
  app.add_option("--noise", share, "of that, white, x radius")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::ofstream out(file, std::ios::binary);
  const std::array<std::int32_t, 4> head = {smoothing::learned::kFormat, smoothing::Features::kEven,
                                            smoothing::Features::kOdd, kTargets};
  out.write(reinterpret_cast<const char*>(head.data()), sizeof head);
  for (std::uint64_t number = first; number < first + count; ++number) {
    Recipe recipe = make_recipe(number);
    TrainingShape made;
    if (shape.empty()) {
      made = make_training_shape(number);
    } else {
      made.mesh = load_shape(shape);
      recipe = Recipe();
      recipe.share = share;
    }
    const Cloud cloud = make_cloud(made, number, recipe);
    in_arena(context, [&] { write(number, cloud, input_of(cloud, recipe, context), wanted, context, out); });
    if (number % 10 == 9) std::fprintf(stderr, "%llu\n", static_cast<unsigned long long>(number + 1));
  }
  return out ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("train_sites", run, argc, argv);
}
