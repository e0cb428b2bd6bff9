#include "tests/bench/quality/ours.h"

#include <chrono>
#include <cmath>
#include <stdexcept>

namespace rfsmooth::bench {
namespace {

/// Sets the one option called `name`.
struct Setter {
  const std::string& name;
  const std::string& text;
  bool found = false;

  void set(bool& field) const { field = text.empty() || text == "true"; }
  void set(int& field) const { field = std::stoi(text); }
  void set(double& field) const { field = std::stod(text); }
  void set(std::string& field) const { field = text; }
  void set(Length& field) const {
    field.value = std::stod(text);
    field.times_spacing = text.back() == 'x';
  }
  template <class T>
  void set(std::optional<T>& field) const {
    set(field.emplace());
  }
  template <class T>
  void operator()(const OptionInfo& info, T& field) {
    if (info.name != name) return;
    found = true;
    set(field);
  }
};

}  // namespace

DenoiseOptions make_options(const std::vector<std::string>& words) {
  DenoiseOptions options;
  for (const auto& word : words) {
    const auto equals = word.find('=');
    const bool off = word.rfind("no-", 0) == 0;
    const std::string name =
        word.substr(off ? 3 : 0, equals == std::string::npos ? equals : equals - (off ? 3 : 0));
    const std::string text = off ? "false" : equals == std::string::npos ? "" : word.substr(equals + 1);
    Setter setter{name, text};
    DenoiseOptions::describe(options, setter);
    if (!setter.found) throw std::invalid_argument("denoise has no option \"" + name + "\"");
  }
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
