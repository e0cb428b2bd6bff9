/// The development data: shapes with a known surface, sampled, normalised, with noise added.
///
/// Shapes: eight meshes of Debian's `libcgal-demo` and five of our own (cube, L-part, sphere, torus, plate).
/// All automatic constants of rfsmooth are tuned on these and on nothing else.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <rfsmooth/mesh.h>

namespace rfsmooth::bench {

/// A clean cloud and the surface it lies on, on the unit sphere of the cloud (centre of the bounding box at
/// the origin, largest radius 1).
struct Sample {
  std::string shape;
  Mesh mesh;           ///< positions and faces only
  Positions clean;     ///< Poisson-disk points of the mesh
  double spacing = 0;  ///< mean distance of a clean point to its nearest neighbour
};

enum class NoiseKind { gaussian, ray };

/// What is added to a clean cloud.
struct Noise {
  NoiseKind kind = NoiseKind::gaussian;
  double sigma =
      0;  ///< standard deviation: per coordinate (gaussian) or along the ray; unit = the sphere's radius
  double outliers =
      0;  ///< stray points as a share of the clean ones, uniform in the bounding box grown by 10 %
  std::string name() const;  ///< "gaussian 1%", "ray 2%", "gaussian 1% + 1% outliers"
};

/// One noisy cloud. Row i < clean.size() is clean[i] with noise; the rows after those are planted outliers.
struct Case {
  std::string name;  ///< "rotor 10000 gaussian 1%"
  std::shared_ptr<const Sample> truth;
  Noise noise;
  Positions noisy;
  bool planted(std::size_t row) const { return row >= truth->clean.size(); }
};

const std::vector<std::string>& shape_names();   ///< all thirteen
const std::vector<std::string>& sharp_shapes();  ///< those with edges: cube, L-part, anchor_dense, rotor

/// The surface of a shape, in its own units; `shape` may also be the path of an OFF file. \throw
/// std::invalid_argument for an unknown name, std::runtime_error if its file is not there.
Mesh load_shape(const std::string& shape);

/// n Poisson-disk points of a shape, normalised. Kept under `cache` (created if absent; empty = not kept;
/// files of other folders are not) and read from there the next time. Same bytes for the same arguments.
std::shared_ptr<const Sample> load_sample(const std::string& shape, std::size_t n,
                                          const std::filesystem::path& cache);

/// The same for a surface of the caller's; nothing is kept.
std::shared_ptr<const Sample> make_sample(const std::string& name, const Mesh& mesh, std::size_t n);

/// Adds noise. Ray noise: six viewpoints at distance 3 on the axes; a point is seen by the one that looks at
/// it most squarely and moves along that ray. Same bytes for the same arguments.
Case make_case(std::shared_ptr<const Sample> sample, const Noise& noise, std::uint64_t seed = 1);

/// The folder that the build uses for samples and peers' results unless another is given.
std::filesystem::path default_cache();

}  // namespace rfsmooth::bench
