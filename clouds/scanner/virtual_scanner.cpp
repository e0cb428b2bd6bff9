/// virtual_scanner: raw scans, even clouds and true meshes of shapes that are known exactly, and what sensors
/// see of a room.
#include <cstdio>
#include <string>

#include "clouds/scanner/arguments.h"
#include "clouds/scanner/laws.h"
#include "clouds/scanner/scan_files.h"
#include "clouds/scanner/scanner.h"
#include "clouds/scanner/sensors.h"
#include "clouds/shapes/sampling.h"
#include "pipeline/io/io.h"
#include "pipeline/io/mesh_file.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::clouds;
namespace io = rfsmooth::pipeline::io;

struct SampleOptions {
  int points = 10000;
  std::string sampling = "poisson_disk";
  double noise = 0;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"points", "how many", "", 2, 1e7}, self.points);
    visit(OptionInfo{"sampling", "even or at random", "", 0, 0, {"poisson_disk", "uniform"}}, self.sampling);
    visit(OptionInfo{"noise", "isotropic Gaussian, standard deviation per coordinate", "x spacing", 0, 100},
          self.noise);
  }
};

struct LawOptions {
  std::string law = "white";
  int points = 10000;
  double times = 1;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    OptionInfo law{"law", "of the noise", "", 0, 0};
    for (const Law& known : laws()) law.choices.push_back(known.name);
    visit(law, self.law);
    visit(OptionInfo{"points", "how many; of rings about as many", "", 2, 1e7}, self.points);
    visit(OptionInfo{"times", "all of the law's noise is larger by this factor", "", 0, 100}, self.times);
  }
};

struct SensorOptions {
  std::string sensor = "rings16";
  double times = 1;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    OptionInfo sensor{"sensor", "that looks at the room", "", 0, 0};
    for (const Sensor& known : sensors()) sensor.choices.push_back(known.name);
    visit(sensor, self.sensor);
    visit(OptionInfo{"times", "all of the sensor's noise is larger by this factor", "", 0, 100}, self.times);
  }
};

struct TruthOptions {
  double edge = 0.05;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"edge", "length of the mesh's edges", "world units", 1e-4, 10}, self.edge);
  }
};

struct Files {
  std::string shape, out, truth;
  std::string encoding;
  bool force = false;

  void write(const io::Cloud& cloud, const std::string& path) const {
    io::WriteOptions options;
    options.force = force;
    options.encoding = io::encoding_by_name(encoding);
    if (!encoding.empty() && !options.encoding)
      throw Failure({ErrorCode::usage,
                     "--encoding is '" + encoding +
                         "'; it must be one of: ascii, binary, binary_big_endian, binary_compressed"});
    value_or_throw(io::write_cloud(cloud, path, options, {}));
    std::printf("%s: %zu points\n", path.c_str(), cloud.size());
  }
};

std::unique_ptr<Shape> find_shape(const std::string& name) {
  std::unique_ptr<Shape> shape = make_shape(name);
  if (shape != nullptr) return shape;
  std::string message = "there is no shape '" + name + "'; there are:";
  for (const std::string_view known : shape_names()) message += " " + std::string(known);
  throw Failure({ErrorCode::usage, message});
}

void run_scan(const Files& files, const ScannerOptions& options, std::uint64_t seed, bool organised) {
  const std::vector<Return> returns = scan(*find_shape(files.shape), options, seed, {});
  files.write(measured_cloud(returns, options, organised), files.out);
  if (!files.truth.empty()) files.write(true_cloud(returns, options, organised), files.truth);
}

Mesh read_surface(const std::string& path) {
  const io::Cloud file = value_or_throw(io::read_cloud(path, {}, {}));
  const std::vector<double> xyz = io::positions(file);
  Mesh mesh;
  for (std::size_t i = 0; i < xyz.size(); i += 3) mesh.positions.emplace_back(xyz[i], xyz[i + 1], xyz[i + 2]);
  mesh.faces = io::value_or_fail(guarded([&] { return io::faces_of(file); }), path);
  if (mesh.faces.empty()) throw Failure({ErrorCode::input_unreadable, path + ": expected faces, found none"});
  return mesh;
}

/// n points of a shape of ours, or of the mesh in a file.
Positions sample_of(const std::string& name, std::size_t n, std::uint64_t seed, Sampling sampling) {
  if (!io::format_of_extension(name)) return sample(*find_shape(name), n, seed, sampling);
  return sample(read_surface(name), n, seed, sampling);
}

void run_sample(const Files& files, const SampleOptions& options, std::uint64_t seed) {
  value_or_throw(validate(options));
  const Sampling sampling = options.sampling == "uniform" ? Sampling::uniform : Sampling::poisson_disk;
  const Positions clean = sample_of(files.shape, std::size_t(options.points), seed, sampling);
  Positions noisy = clean;
  add_noise(noisy, options.noise * mean_spacing(clean), seed + 1);
  files.write(plain_cloud(noisy), files.out);
  if (!files.truth.empty()) files.write(plain_cloud(clean), files.truth);
}

void run_law(const Files& files, const LawOptions& options, std::uint64_t seed) {
  value_or_throw(validate(options));
  constexpr double kEdge = 0.02;  // facets of curved shapes are off by 5e-5
  const bool file = io::format_of_extension(files.shape).has_value();
  const Mesh mesh = file ? read_surface(files.shape) : find_shape(files.shape)->mesh(kEdge);
  const Law law = scaled(*find_law(options.law), options.times);
  const Spots spots = spread(law, mesh, std::size_t(options.points), seed);
  const NoisyCloud cloud = add_noise(law, spots, mean_spacing(spots.points), seed + 1);
  files.write(plain_cloud(cloud.measured), files.out);
  if (!files.truth.empty()) files.write(plain_cloud(spots.points), files.truth);
}

void run_sensor(const Files& files, const SensorOptions& options, std::uint64_t seed) {
  value_or_throw(validate(options));
  const Sight sight = look(scaled(*find_sensor(options.sensor), options.times), seed);
  files.write(plain_cloud(sight.measured), files.out);
  if (!files.truth.empty()) files.write(plain_cloud(sight.truth), files.truth);
}

void run_truth(const Files& files, const TruthOptions& options) {
  value_or_throw(validate(options));
  const Mesh mesh = find_shape(files.shape)->mesh(options.edge);
  files.write(io::make_mesh_file(mesh.positions, mesh.faces, {}), files.out);
}

int run(int argc, char** argv) {
  CLI::App app("Raw scans, even clouds and true meshes of shapes and rooms that are known exactly.");
  app.require_subcommand(1);
  Files files;
  std::uint64_t seed = 1;
  bool organised = false;
  ScannerOptions scanner;
  SampleOptions sampler;
  LawOptions law;
  SensorOptions sensor;
  TruthOptions truth;

  const auto command = [&](const std::string& name, const std::string& help, bool cloud) {
    CLI::App* sub = app.add_subcommand(name, help);
    if (name != "sensor")
      sub->add_option("SHAPE", files.shape,
                      name == "sample" || name == "law"
                          ? "a mesh file (.ply, .off), or sphere, torus, cube, l_part, plate, "
                            "wavy_sheet, two_density_sphere"
                          : "sphere, torus, cube, l_part, plate, wavy_sheet or two_density_sphere")
          ->required();
    sub->add_option("OUT", files.out, cloud ? "cloud to write: .ply, .pcd or .xyz" : "mesh to write: .ply")
        ->required();
    sub->add_flag("--force", files.force, "replace existing files");
    if (!cloud) return sub;
    sub->add_option("--truth", files.truth, "also write the clean cloud, in the same order");
    sub->add_option("--seed", seed, "of the random numbers: the same seed gives the same bytes")
        ->capture_default_str();
    sub->add_option("--encoding", files.encoding, "ascii | binary | binary_big_endian | binary_compressed");
    return sub;
  };
  CLI::App* scan_command =
      command("scan", "Scan a shape from several viewpoints, with all that goes wrong.", true);
  bind(*scan_command, scanner);
  scan_command->add_flag("--organised", organised, "keep the grid of rays, NaN where nothing was hit");
  CLI::App* sample_command = command("sample", "Spread points over a shape and add isotropic noise.", true);
  bind(*sample_command, sampler);
  CLI::App* law_command =
      command("law", "Points of a shape with the noise of a real scanner, law by law.", true);
  bind(*law_command, law);
  CLI::App* sensor_command =
      command("sensor", "What a laser or a depth camera sees of a room, in metres from itself.", true);
  bind(*sensor_command, sensor);
  CLI::App* truth_command = command("truth", "Write the shape itself as a mesh.", false);
  bind(*truth_command, truth);
  if (const auto ended = clouds::parse(app, argc, argv)) return *ended;
  if (*scan_command) run_scan(files, scanner, seed, organised);
  if (*sample_command) run_sample(files, sampler, seed);
  if (*law_command) run_law(files, law, seed);
  if (*sensor_command) run_sensor(files, sensor, seed);
  if (*truth_command) run_truth(files, truth);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return rfsmooth::clouds::tell_failures("virtual_scanner", run, argc, argv);
}
