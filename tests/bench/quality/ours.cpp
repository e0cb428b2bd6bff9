#include "tests/bench/quality/ours.h"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include "pipeline/cli/options/option.h"

namespace rfsmooth::bench {

DenoiseOptions make_options(const std::vector<std::string>& words) {
  DenoiseOptions options;
  const std::vector<cli::CommandOption> known = cli::collect(options);
  for (const auto& word : words) {
    const auto equals = word.find('=');
    const bool off = word.rfind("no-", 0) == 0;
    const std::string name = word.substr(0, equals).substr(off ? 3 : 0);
    const cli::CommandOption* const option = cli::find_option(known, name);
    if (option == nullptr) throw std::invalid_argument("denoise has no option \"" + name + "\"");
    cli::assign(*option, off ? "false" : equals == std::string::npos ? "true" : word.substr(equals + 1));
  }
  for (const auto& option : known)
    if (option.finish) option.finish();
  return options;
}

OurResult run_ours(const Positions& noisy, const Variant& variant, int threads) {
  Context context;
  context.threads = threads;
  OurResult result;
  result.points = noisy;
  const auto options = make_options(variant.options);
  const auto start = std::chrono::steady_clock::now();
  auto report = rfsmooth::denoise(result.points.data()->data(), result.points.size(), options, context);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!report) throw std::runtime_error(report.error().message);
  result.report = std::move(report).value();
  return result;
}

Moves moves(const Positions& before, const Positions& after) {
  Moves m;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double d = (after[i] - before[i]).squaredNorm();
    m.largest = std::max(m.largest, d);
    m.rms += d;
  }
  m.largest = std::sqrt(m.largest);
  m.rms = before.empty() ? 0 : std::sqrt(m.rms / double(before.size()));
  return m;
}

}  // namespace rfsmooth::bench
