/// Real scans: rfsmooth beside PCL's MLS and CGAL's jets on the planes and creases that they have
/// (../README.md).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "pipeline/io/io.h"
#include "tests/bench/scans/scan_runs.h"
#include "tests/bench/support/main.h"

namespace {

using namespace rfsmooth;
using namespace rfsmooth::bench;
namespace fs = std::filesystem;

constexpr std::size_t kLeastPoints = 1000;  // smaller clouds have no room for a patch

struct Settings {
  std::vector<fs::path> inputs = {RFSMOOTH_SCANS_DIR};
  std::vector<std::string> only;
  std::size_t most = 250000;
  bool turned = false;
  int threads = 2;
  Variant ours = {"rfsmooth", {}};
  fs::path cache = default_cache(), write;
};

/// One scan: raw, ours, MLS, jet, in this order wherever there are four.
struct Judged {
  std::string name;
  std::size_t points = 0, planes = 0, patches = 0, creases = 0;
  std::array<FlatError, 4> errors;
  double noise = 0, left = 0, moved = 0;  ///< as the report says and as it was, median spacings
};

std::vector<fs::path> files_of(const Settings& settings) {
  std::vector<fs::path> files;
  for (const auto& input : settings.inputs) {
    if (!fs::is_directory(input)) files.push_back(input);
    if (!fs::is_directory(input)) continue;
    for (const auto& entry : fs::directory_iterator(input)) {
      const std::string kind = entry.path().extension().string();
      if (kind == ".pcd" || kind == ".ply" || kind == ".xyz") files.push_back(entry.path());
    }
  }
  const auto unwanted = [&](const fs::path& file) {
    return !settings.only.empty() &&
           std::find(settings.only.begin(), settings.only.end(), file.stem().string()) == settings.only.end();
  };
  files.erase(std::remove_if(files.begin(), files.end(), unwanted), files.end());
  std::sort(files.begin(), files.end());
  return files;
}

/// What `rfsmooth render` takes to put before, ours and MLS side by side.
void write_clouds(const fs::path& folder, const std::string& name, const std::array<Cleaned, 4>& tools) {
  constexpr std::array<const char*, 3> kWritten = {"_raw.ply", "_ours.ply", "_mls.ply"};
  fs::create_directories(folder);
  pipeline::io::WriteOptions options;
  options.force = true;
  for (std::size_t tool = 0; tool < kWritten.size(); ++tool) {
    const Positions& points = tools[tool].points;
    const auto cloud =
        pipeline::io::make_cloud(points.front().data(), points.size(), pipeline::io::Scalar::float32);
    value_or_throw(pipeline::io::write_cloud(cloud, folder / (name + kWritten[tool]), options, {}));
  }
}

Judged judge(const Settings& settings, const Scan& scan) {
  constexpr std::uint64_t kSeed = 23;
  const Flats flats = find_flats(scan.points, kSeed);
  Judged judged;
  judged.name = scan.name;
  judged.points = scan.points.size();
  judged.planes = flats.planes;
  judged.patches = flats.patches.size();
  judged.creases = flats.creases.size();
  const auto ours = run_ours(scan, settings.ours, settings.threads);
  judged.noise = ours.report.noise / scan.spacing;
  judged.left = ours.report.noise_left.value_or(ours.report.noise) / scan.spacing;
  judged.moved = moves(scan.points, ours.points).rms / scan.spacing;
  const std::array<Cleaned, 4> tools = {Cleaned{scan.points, {}}, Cleaned{ours.points, {}},
                                        run_peer(scan, kFixedMls, settings.cache, settings.threads),
                                        run_peer(scan, kFixedJet, settings.cache, settings.threads)};
  Context context;
  context.threads = settings.threads;
  for (std::size_t tool = 0; tool < tools.size(); ++tool)
    judged.errors[tool] = measure_flats(flats, scan.points.size(), tools[tool], context);
  if (!settings.write.empty()) write_clouds(settings.write, scan.name, tools);
  return judged;
}

/// Ours over MLS and over jet; 0 without a measurement.
std::array<double, 2> ratios(const Judged& judged, double FlatError::*figure) {
  std::array<double, 2> over{};
  for (std::size_t peer = 0; peer < 2; ++peer) {
    const double theirs = judged.errors[2 + peer].*figure;
    if (theirs > 0) over[peer] = judged.errors[1].*figure / theirs;
  }
  return over;
}

/// Raw, ours, MLS, jet and the two ratios.
void print_figure(const Judged& judged, double FlatError::*figure, int decimals) {
  if (!(judged.errors[0].*figure > 0)) {
    std::printf(" %-37s |", "-");
    return;
  }
  for (const FlatError& error : judged.errors) std::printf(" %5.*f", decimals, error.*figure);
  const auto over = ratios(judged, figure);
  std::printf(" %5.2f %5.2f  |", over[0], over[1]);
}

void print_head() {
  std::printf(
      "Geometric means over the places. Planes: rms distance in spacings; normals: mean error in degrees; "
      "creases: "
      "rms distance to the nearer plane in spacings; then ours over MLS's and jet's\n%-34s %7s %3s %4s %4s | "
      "%-37s | %-37s | %-37s | "
      "%-20s\n%-56s |",
      "scan", "points", "pl", "pat", "crs", "planes", "normals", "creases", "report, spacings", "");
  for (int block = 0; block < 3; ++block)
    std::printf(" %5s %5s %5s %5s %5s %5s  |", "raw", "ours", "MLS", "jet", "/MLS", "/jet");
  std::printf(" %6s %6s %6s\n", "noise", "left", "moved");
}

void print(const Judged& judged) {
  std::printf("%-34s %7zu %3zu %4zu %4zu |", judged.name.c_str(), judged.points, judged.planes,
              judged.patches, judged.creases);
  print_figure(judged, &FlatError::plane, 3);
  print_figure(judged, &FlatError::normal, 2);
  print_figure(judged, &FlatError::crease, 3);
  std::printf(" %6.3f %6.3f %6.3f\n", judged.noise, judged.left, judged.moved);
  std::fflush(stdout);
}

/// How many scans reach a mark.
void print_mark(const std::vector<Judged>& scans, const char* what, double FlatError::*figure, double mark) {
  std::size_t measured = 0, reached = 0;
  std::string missed;
  for (const Judged& scan : scans) {
    if (!(scan.errors[0].*figure > 0)) continue;
    const auto over = ratios(scan, figure);
    ++measured;
    if (std::max(over[0], over[1]) <= mark)
      ++reached;
    else
      missed += " " + scan.name;
  }
  std::printf("%s at most %.1f of MLS's and jet's: %zu of %zu scans; not:%s\n", what, mark, reached, measured,
              missed.c_str());
}

void print_marks(const std::vector<Judged>& scans) {
  std::printf("\n");
  print_mark(scans, "planes", &FlatError::plane, 1);
  print_mark(scans, "normals", &FlatError::normal, 1);
  print_mark(scans, "creases", &FlatError::crease, 0.9);
  std::printf("untouched, though planes are rougher than 0.1 spacings:");
  for (const Judged& scan : scans)
    if (scan.moved == 0 && scan.errors[0].plane > 0.1) std::printf(" %s", scan.name.c_str());
  std::printf("\n");
}

int run(int argc, char** argv) {
  Settings settings;
  std::vector<fs::path> more;
  CLI::App app{"rfsmooth beside its peers on real scans"};
  app.add_option("--scans", settings.inputs, "folders of clouds, or clouds")->capture_default_str();
  app.add_option("--more", more, "more of them: data/points_3 of libcgal-demo's data.tar.gz, unpacked");
  app.add_option("--only", settings.only, "scans by their names, without the ending");
  app.add_option("--points", settings.most, "of a larger cloud only these, about its middle")
      ->capture_default_str();
  app.add_flag("--turned", settings.turned, "turned and moved, as scans are that were registered");
  app.add_option("--options", settings.ours.options, "options of denoise: flow=hc no-swap ...");
  app.add_option("--threads", settings.threads, "for every tool")->capture_default_str();
  app.add_option("--cache", settings.cache, "folder of the peers' results")->capture_default_str();
  app.add_option("--write", settings.write,
                 "folder for NAME_raw.ply, NAME_ours.ply and NAME_mls.ply (see sheet.sh)");
  CLI11_PARSE(app, argc, argv);
  settings.inputs.insert(settings.inputs.end(), more.begin(), more.end());
  std::vector<Judged> scans;
  print_head();
  for (const auto& file : files_of(settings)) {
    try {
      Scan scan = read_scan(file, settings.most);
      if (settings.turned) turn(scan);
      if (scan.points.size() < kLeastPoints) continue;
      scans.push_back(judge(settings, scan));
      print(scans.back());
    } catch (const std::invalid_argument&) {
      throw;  // an option that does not exist
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s: %s\n", file.c_str(), e.what());
    }
  }
  print_marks(scans);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("scans", run, argc, argv);
}
