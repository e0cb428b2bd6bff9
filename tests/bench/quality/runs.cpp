#include "tests/bench/quality/runs.h"

#include <chrono>
#include <cstdio>
#include <exception>

namespace rfsmooth::bench {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

std::vector<Noise> standard_noises() {
  return {{NoiseKind::gaussian, 0.01, 0},
          {NoiseKind::gaussian, 0.02, 0},
          {NoiseKind::gaussian, 0.03, 0},
          {NoiseKind::ray, 0.02, 0},
          {NoiseKind::gaussian, 0.01, 0.01}};
}

std::shared_ptr<const Sample> Cases::sample(const std::string& shape, std::size_t size) {
  auto& kept = samples_[{shape, size}];
  if (!kept) kept = load_sample(shape, size, plan_.cache);
  return kept;
}

Case Cases::make(const std::string& shape, std::size_t size, const Noise& noise) {
  return make_case(sample(shape, size), noise);
}

const Truth& Cases::truth(const std::string& shape, std::size_t size) {
  const auto key = std::make_pair(shape, size);
  const auto found = truths_.find(key);
  if (found != truths_.end()) return found->second;
  return truths_.emplace(key, Truth(sample(shape, size))).first->second;
}

Cell cached_peers(const Plan& plan, Cases& cases, std::size_t size, const Noise& noise) {
  const Store store(plan.cache / "peers");
  Cell cell;
  for (const auto& shape : plan.shapes) {
    const auto input = hash_points(cases.make(shape, size, noise).noisy);
    for (const auto& setting : peer_settings())
      if (const auto row = store.row(input, setting.name)) cell[setting.name][shape] = *row;
  }
  return cell;
}

std::size_t run_peers(const Plan& plan, Cases& cases) {
  const Store store(plan.cache / "peers");
  Context context;
  context.threads = plan.threads;
  std::size_t runs = 0;
  for (int tier = 0; tier <= plan.most_tier; ++tier)
    for (const std::size_t size : plan.sizes)
      for (const auto& noise : plan.noises)
        for (const auto& shape : plan.shapes) {
          const Case one = cases.make(shape, size, noise);
          const auto input = hash_points(one.noisy);
          for (const auto& setting : peer_settings()) {
            if (setting.tier != tier || store.row(input, setting.name)) continue;
            try {
              Row row;
              row.threads = plan.threads;
              std::optional<peers::Smoothed> from;
              if (!setting.base.empty()) {
                from = store.cloud(input, setting.base);
                row.seconds = store.row(input, setting.base).value().seconds;
              }
              const auto start = std::chrono::steady_clock::now();
              const auto result = setting.run(from ? from->points : one.noisy, plan.threads);
              row.seconds += seconds_since(start);
              row.measures = cases.truth(shape, size).measure(result.points, result.source, context);
              store.save(input, setting.name, result, row);
              ++runs;
              std::fprintf(stderr, "%s: %s: CD %.3f p2s %.3f x1e-4, %.2f s\n", one.name.c_str(),
                           setting.name.c_str(), 1e4 * row.measures.chamfer, 1e4 * row.measures.p2s,
                           row.seconds);
            } catch (const std::exception& e) {
              std::fprintf(stderr, "%s: %s: failed: %s\n", one.name.c_str(), setting.name.c_str(), e.what());
            }
          }
        }
  return runs;
}

peers::Smoothed peer_result(const std::filesystem::path& cache, const Positions& points,
                            const std::string& setting, int threads) {
  const PeerSetting& peer = peer_setting(setting);
  const Store store(cache / "peers");
  const auto input = hash_points(points);
  if (auto known = store.cloud(input, setting)) return *std::move(known);
  auto result = peer.run(points, threads);
  Row row;
  row.threads = threads;
  store.save(input, setting, result, row);
  return result;
}

}  // namespace rfsmooth::bench
