#include "tests/bench/quality/data/store.h"

#include <cstdio>
#include <fstream>

#include <nlohmann/json.hpp>
#include <unistd.h>

namespace rfsmooth::bench {
namespace {

namespace fs = std::filesystem;

/// Part of every name: change it when what a setting does changes (settings.cpp, peers/).
constexpr int kPeersVersion = 1;
/// Kept with every row: change it when measure.cpp changes meaning; rows of another version are not read.
constexpr int kMeasureVersion = 1;

void write_whole(const fs::path& file, const std::string& bytes) {
  const fs::path partial = file.string() + ".part" + std::to_string(getpid());
  std::ofstream out(partial, std::ios::binary);
  out.write(bytes.data(), std::streamsize(bytes.size()));
  out.close();
  if (!out) throw std::runtime_error("cannot write " + partial.string());
  fs::rename(partial, file);
}

}  // namespace

std::uint64_t hash_points(const Positions& points) {
  std::uint64_t h = 14695981039346656037ULL;
  const auto* bytes = reinterpret_cast<const unsigned char*>(points.data());
  for (std::size_t i = 0; i < points.size() * sizeof(Eigen::Vector3d); ++i)
    h = (h ^ bytes[i]) * 1099511628211ULL;
  return h;
}

Store::Store(fs::path folder) : folder_(std::move(folder)) {
  fs::create_directories(folder_);
}

fs::path Store::file(std::uint64_t input, const std::string& setting, const char* ending) const {
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(input));
  std::string name = setting;
  for (auto& c : name)
    if (c == ' ') c = '_';
  return folder_ / hash / (name + "-v" + std::to_string(kPeersVersion) + ending);
}

std::optional<Row> Store::row(std::uint64_t input, const std::string& setting) const {
  std::ifstream in(file(input, setting, ".json"));
  if (!in) return std::nullopt;
  const auto j = nlohmann::json::parse(in, nullptr, false);
  if (j.is_discarded() || j.value("measure_version", 0) != kMeasureVersion) return std::nullopt;
  Row r;
  r.seconds = j.at("seconds");
  r.threads = j.at("threads");
  r.measures.chamfer = j.at("chamfer");
  r.measures.p2s = j.at("p2s");
  r.measures.p2s_max = j.at("p2s_max");
  r.measures.normal = j.at("normal");
  r.measures.evenness = j.at("evenness");
  r.measures.edge_p2s = j.at("edge_p2s");
  r.measures.points = j.at("points");
  r.measures.edge_points = j.at("edge_points");
  return r;
}

std::optional<peers::Smoothed> Store::cloud(std::uint64_t input, const std::string& setting) const {
  std::ifstream in(file(input, setting, ".points"), std::ios::binary);
  std::uint64_t n = 0, m = 0;
  if (!in.read(reinterpret_cast<char*>(&n), sizeof n) || !in.read(reinterpret_cast<char*>(&m), sizeof m))
    return std::nullopt;
  std::vector<Eigen::Vector3f> points(n);
  peers::Smoothed result;
  result.source.resize(m);
  in.read(reinterpret_cast<char*>(points.data()), std::streamsize(n * sizeof(Eigen::Vector3f)));
  in.read(reinterpret_cast<char*>(result.source.data()), std::streamsize(m * sizeof(Index)));
  if (!in) return std::nullopt;
  for (const auto& p : points) result.points.push_back(p.cast<double>());
  return result;
}

void Store::save(std::uint64_t input, const std::string& setting, const peers::Smoothed& cloud,
                 const Row& row) const {
  fs::create_directories(file(input, setting, "").parent_path());
  std::string bytes;
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  append(std::uint64_t(cloud.points.size()));
  append(std::uint64_t(cloud.source.size()));
  for (const auto& p : cloud.points)
    for (int axis = 0; axis < 3; ++axis) append(float(p[axis]));
  for (const Index i : cloud.source) append(i);
  write_whole(file(input, setting, ".points"), bytes);
  const auto& m = row.measures;
  const nlohmann::json j = {{"measure_version", kMeasureVersion},
                            {"setting", setting},
                            {"seconds", row.seconds},
                            {"threads", row.threads},
                            {"chamfer", m.chamfer},
                            {"p2s", m.p2s},
                            {"p2s_max", m.p2s_max},
                            {"normal", m.normal},
                            {"evenness", m.evenness},
                            {"edge_p2s", m.edge_p2s},
                            {"points", m.points},
                            {"edge_points", m.edge_points}};
  write_whole(file(input, setting, ".json"), j.dump(1) + "\n");
}

}  // namespace rfsmooth::bench
