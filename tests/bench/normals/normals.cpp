/// Normals of noisy clouds beside PCL's and CGAL's: angle error, share that point outward, time
/// (../README.md).
///
/// rfsmooth denoises and then estimates; the peers get the noisy cloud and the number of neighbours that
/// suits them best, picked with the truth in hand. The true normal of a row is that of the surface nearest to
/// where the tool has the row.
#include "rfsmooth/pipeline/normals.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>

#include "rfsmooth/clouds/sampling.h"
#include "rfsmooth/rfs_mesh/measure.h"
#include "rfsmooth/rfs_mesh/parallel.h"

#include "peers.h"
#include "quality/closest.h"
#include "quality/dataset.h"
#include "quality/ours.h"
#include "support/main.h"
#include "support/median.h"

namespace {

using namespace rfsmooth::bench;
using peers::Normals;
using rfsmooth::Context;
using rfsmooth::Positions;

constexpr double kDegrees = 180 / 3.14159265358979323846;

struct Score {
  double angle = 0;    ///< mean unsigned angle, degrees
  double outward = 0;  ///< share on the right side
};

class TrueNormals {
 public:
  explicit TrueNormals(const Sample& sample) : surface_(sample.mesh) {
    for (const auto& f : sample.mesh.faces) {
      const auto& at = sample.mesh.positions;
      faces_.push_back((at[f[1]] - at[f[0]]).cross(at[f[2]] - at[f[0]]).normalized());
    }
  }

  /// The share of the points whose true normals here and there are opposite: on features that are thin beside
  /// the noise, or round a sharp edge, a point's side is lost.
  double sides_lost(const Positions& here, const Positions& there) const {
    std::vector<char> lost(here.size());
    rfsmooth::for_each_index(Context(), here.size(), [&](std::size_t i) {
      const auto& one = faces_[surface_.nearest(here[i]).primitive];
      const auto& other = faces_[surface_.nearest(there[i]).primitive];
      lost[i] = one.dot(other) < 0 ? 1 : 0;
    });
    return double(std::count(lost.begin(), lost.end(), 1)) / double(here.size());
  }

  Score score(const Positions& at, const Normals& normals) const {
    struct Sum {
      double angle = 0, outward = 0;
    };
    const Sum sum = rfsmooth::reduce_blocks(
        Context(), at.size(), Sum{},
        [&](std::size_t begin, std::size_t end) {
          Sum s;
          for (std::size_t i = begin; i < end; ++i) {
            const double cosine = normals[i].dot(faces_[surface_.nearest(at[i]).primitive]);
            s.angle += kDegrees * std::acos(std::min(1.0, std::abs(cosine)));
            s.outward += cosine > 0 ? 1 : 0;
          }
          return s;
        },
        [](Sum a, const Sum& b) {
          return Sum{a.angle + b.angle, a.outward + b.outward};
        });
    return {sum.angle / double(at.size()), sum.outward / double(at.size())};
  }

 private:
  ClosestTree surface_;
  std::vector<Eigen::Vector3d> faces_;
};

Normals ours(const Positions& points, int threads) {
  Normals normals(points.size());
  Context context;
  context.threads = threads;
  const auto done = rfsmooth::pipeline::estimate_normals(points.data()->data(), points.size(), {}, context,
                                                         normals.data()->data());
  if (!done) throw std::runtime_error(done.error().message);
  return normals;
}

template <class Work>
double seconds_of(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Compared {
  double ours = 0, outward = 0, pcl = 0, cgal = 0, cgal_outward = 0;
};

Compared run_shape(const std::string& shape, std::size_t n, double noise, const std::vector<int>& neighbours,
                   const std::filesystem::path& cache, bool with_peers) {
  const auto sample = load_sample(shape, n, cache);
  const TrueNormals truth(*sample);
  const Case data = make_case(sample, {NoiseKind::gaussian, noise, 0});
  const Positions smooth = run_ours(data.noisy, {}, 0).points;
  const Score own = truth.score(smooth, ours(smooth, 0));
  Compared row;
  row.ours = own.angle;
  row.outward = own.outward;
  std::printf("%-14s %7zu %3.0f %%  %6.2f %8.3f %6.2f", shape.c_str(), n, 100 * noise, own.angle,
              100 * own.outward, 100 * truth.sides_lost(sample->clean, smooth));
  if (with_peers) {
    Score pcl{std::numeric_limits<double>::infinity(), 0}, cgal = pcl;
    int pcl_k = 0, cgal_k = 0;
    for (const int k : neighbours) {
      const Score p = truth.score(data.noisy, peers::pcl_normals(data.noisy, k, 0));
      const Score c = truth.score(data.noisy, peers::cgal_normals(data.noisy, k, 0));
      if (p.angle < pcl.angle) pcl = p, pcl_k = k;
      if (c.angle < cgal.angle) cgal = c, cgal_k = k;
    }
    row.pcl = own.angle / pcl.angle;
    row.cgal = own.angle / cgal.angle;
    row.cgal_outward = cgal.outward;
    std::printf("   %6.2f (%3d) %5.2f   %6.2f (%3d) %5.2f %8.3f", pcl.angle, pcl_k, row.pcl, cgal.angle,
                cgal_k, row.cgal, 100 * cgal.outward);
  }
  std::printf("\n");
  std::fflush(stdout);
  return row;
}

/// Random points of a shape with noise of 0.6 mean distances to the nearest neighbour of an even sampling.
Positions large_cloud(const std::string& shape, std::size_t n) {
  const auto mesh = load_shape(shape);
  const double area = rfsmooth::rfs_mesh::surface_area(mesh, {});
  Positions points = rfsmooth::clouds::sample(mesh, n, 1, rfsmooth::clouds::Sampling::uniform);
  rfsmooth::clouds::add_noise(points, 0.6 * std::sqrt(area / double(n)), 2);
  return points;
}

void speed(const std::string& shape, std::size_t n, int rounds, int threads) {
  constexpr int kNeighbours = 18;  // the value of CGAL's own example
  const Positions points = large_cloud(shape, n);
  std::printf("\n%zu points of %s, %d thread(s), seconds; CGAL with k = %d\n", n, shape.c_str(), threads,
              kNeighbours);
  std::printf("%10s %10s %10s %10s\n", "normals", "PCL", "CGAL", "ours/CGAL");
  std::vector<double> ratios;
  for (int round = 0; round < rounds; ++round) {
    const double own = seconds_of([&] { ours(points, threads); });
    const double pcl = seconds_of([&] { peers::pcl_normals(points, kNeighbours, threads); });
    const double cgal = seconds_of([&] { peers::cgal_normals(points, kNeighbours, threads); });
    ratios.push_back(own / cgal);
    std::printf("%10.2f %10.2f %10.2f %10.3f\n", own, pcl, cgal, own / cgal);
    std::fflush(stdout);
  }
  std::printf("median of the ratios %.3f [below 1]\n", median(ratios));
}

int run(int argc, char** argv) {
  CLI::App app("Accuracy, side and speed of normals beside PCL's and CGAL's");
  std::vector<std::string> shapes = {"anchor_dense", "rotor", "armadillo", "hand", "femur", "knot1"};
  std::vector<std::size_t> sizes = {50000};
  std::vector<double> noises = {0.01};
  std::vector<int> neighbours = {12, 18, 24, 32, 48, 64, 96, 128, 200};
  std::string cache = default_cache().string();
  bool no_peers = false, no_speed = false;
  std::size_t large = 1000000;
  int rounds = 3;
  app.add_option("--shapes", shapes, "development shapes")->delimiter(',');
  app.add_option("--sizes", sizes, "points")->delimiter(',');
  app.add_option("--noises", noises, "share of the radius, per coordinate")->delimiter(',');
  app.add_option("--neighbours", neighbours, "what the peers may choose from")->delimiter(',');
  app.add_option("--cache", cache, "where samples are kept");
  app.add_flag("--no-peers", no_peers, "ours only");
  app.add_flag("--no-speed", no_speed, "leave out the large cloud");
  app.add_option("--large", large, "points of the large cloud");
  app.add_option("--rounds", rounds, "of the large cloud");
  CLI11_PARSE(app, argc, argv);

  std::printf(
      "mean angle to the true normal in degrees; outward in %%; lost: points whose true normal is reversed "
      "between where they were sampled and where they ended, in %%; peers with their best k, ours / "
      "theirs\n");
  std::printf("%-14s %7s %5s  %6s %8s %6s", "shape", "points", "noise", "ours", "outward", "lost");
  if (!no_peers)
    std::printf("   %12s %5s   %12s %5s %8s", "PCL (k)", "ratio", "CGAL (k)", "ratio", "outward");
  std::printf("\n");
  double worst_pcl = 0, worst_cgal = 0, least_outward = 1;
  for (const std::size_t n : sizes)
    for (const double noise : noises)
      for (const auto& shape : shapes) {
        const Compared row = run_shape(shape, n, noise, neighbours, cache, !no_peers);
        worst_pcl = std::max(worst_pcl, row.pcl);
        worst_cgal = std::max(worst_cgal, row.cgal);
        least_outward = std::min(least_outward, row.outward);
      }
  std::printf("least outward %.3f %% [99.9]", 100 * least_outward);
  if (!no_peers) std::printf("; worst ratio to PCL %.2f [0.6], to CGAL %.2f [0.6]", worst_pcl, worst_cgal);
  std::printf("\n");
  if (!no_speed)
    for (const int threads : {1, 4}) speed("knot1", large, rounds, threads);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("normals", run, argc, argv);
}
