/// The quality benchmark: rfsmooth beside every peer on the development shapes (../README.md).
#include <algorithm>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "tests/bench/quality/goals.h"
#include "tests/bench/support/main.h"

namespace {

using namespace rfsmooth::bench;

/// Runs the variants and fills in what the peers' cache holds.
Results collect(const Plan& plan, Cases& cases, const std::vector<Variant>& variants) {
  rfsmooth::Context context;
  context.threads = plan.threads;
  const Store store(plan.cache / "peers");
  Results results;
  for (const std::size_t size : plan.sizes)
    for (const auto& noise : plan.noises) {
      Cell& cell = results[{noise.name(), size}];
      cell = cached_peers(plan, cases, size, noise);
      for (const auto& shape : plan.shapes) {
        const Case one = cases.make(shape, size, noise);
        const auto input = hash_points(one.noisy);
        auto untouched = store.row(input, "noisy input");
        if (!untouched) {
          untouched = Row{cases.truth(shape, size).measure(one.noisy, {}, context), 0, 0};
          store.save(input, "noisy input", {one.noisy, {}}, *untouched);
        }
        cell["noisy input"][shape] = *untouched;
        for (const auto& variant : variants) {
          try {
            const auto run = run_ours(one.noisy, variant, plan.threads);
            cell[variant.name][shape] = {cases.truth(shape, size).measure(run.points, {}, context),
                                         run.seconds, plan.threads};
          } catch (const std::invalid_argument&) {
            throw;  // an option that does not exist
          } catch (const std::exception& e) {
            std::fprintf(stderr, "%s: %s: failed: %s\n", one.name.c_str(), variant.name.c_str(), e.what());
          }
        }
      }
      std::fprintf(stderr, "%zu points, %s: done\n", size, noise.name().c_str());
    }
  return results;
}

int run(int argc, char** argv) {
  Plan plan;
  plan.noises = standard_noises();
  plan.cache = default_cache();
  plan.threads = 2;
  bool quick = false, all = false, peers_only = false, no_peers = false, no_goals = false;
  std::vector<std::string> options, extra, noises;
  std::string csv;
  CLI::App app{"rfsmooth beside its peers on the development shapes"};
  app.add_flag("--quick", quick, "six shapes, 10,000 points, the strongest peers: minutes from nothing");
  app.add_flag("--all", all, "print every peer setting, not the best of each family");
  app.add_flag("--peers-only", peers_only, "run the peers that the cache lacks and stop");
  app.add_flag("--no-peers", no_peers, "run no peer, use what the cache has");
  app.add_flag("--no-goals", no_goals, "tables and ratios only, without the goals on data of their own");
  app.add_option("--cache", plan.cache, "folder of samples and peers' results")->capture_default_str();
  app.add_option("--threads", plan.threads, "for every tool")->capture_default_str();
  app.add_option("--shapes", plan.shapes, "only these; the path of an OFF file is one, too");
  app.add_option("--sizes", plan.sizes, "numbers of points")->capture_default_str();
  app.add_option("--noises", noises, "only these: \"gaussian 2%\" ...");
  app.add_option("--tier", plan.most_tier, "0: only the strong quick peers, 1: all but WLOP, 2: all")
      ->capture_default_str();
  app.add_option("--options", options, "options of denoise for every run of ours: flow=hc no-swap ...");
  app.add_option("--variant", extra, "one more variant: its options, separated by commas")->take_all();
  app.add_option("--csv", csv, "write every row to this file");
  CLI11_PARSE(app, argc, argv);
  if (quick) {
    plan.shapes = {"anchor_dense", "rotor", "armadillo", "hand", "cube", "torus"};
    plan.sizes = {10000};
    plan.noises.resize(3);
    plan.most_tier = 0;
  }

  const auto unwanted = [&](const Noise& noise) {
    return !noises.empty() && std::find(noises.begin(), noises.end(), noise.name()) == noises.end();
  };
  plan.noises.erase(std::remove_if(plan.noises.begin(), plan.noises.end(), unwanted), plan.noises.end());

  Cases cases(plan);
  if (!no_peers) std::fprintf(stderr, "%zu runs of peers made\n", run_peers(plan, cases));
  if (peers_only) return 0;

  std::vector<Variant> variants = {{"rfsmooth", options}, {"rfsmooth --no-equalize", options}};
  variants[1].options.emplace_back("no-equalize");
  for (const auto& text : extra) {
    Variant variant{"rfsmooth " + text, options};
    for (const auto& word : CLI::detail::split(text, ',')) variant.options.push_back(word);
    variants.push_back(variant);
  }
  try {
    make_options(variants[1].options);
  } catch (const std::invalid_argument&) {
    variants.erase(variants.begin() + 1);
  }
  const Results results = collect(plan, cases, variants);
  std::vector<std::string> names;
  names.reserve(variants.size());
  for (const auto& variant : variants) names.push_back(variant.name);
  print_tables(plan, results, names, all);
  print_ratios(plan, results, "rfsmooth", "rfsmooth --no-equalize");
  if (!no_goals) {
    std::printf("\nGoals on data of their own\n");
    print_no_harm(plan, cases, variants.front());
    print_thin_plate(plan, variants.front());
    print_open_sheet(plan, variants.front());
    print_outliers(plan, cases);
    print_repeatability(plan, cases, variants.front());
  }
  if (!csv.empty()) write_csv(csv, results);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return tell_failures("quality", run, argc, argv);
}
