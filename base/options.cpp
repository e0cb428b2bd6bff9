#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rfsmooth/options.h>

namespace rfsmooth::detail {

std::optional<Error> check_range(const OptionInfo& info, double value) {
  if (value >= info.min && value <= info.max) return std::nullopt;  // false for NaN too
  const bool below = std::isfinite(info.min), above = std::isfinite(info.max);
  const std::string range = below && above ? fmt::format("between {} and {}", info.min, info.max)
                            : below        ? fmt::format("at least {}", info.min)
                            : above        ? fmt::format("at most {}", info.max)
                                           : std::string("a number");
  return Error{ErrorCode::usage, fmt::format("`{}` is {}; it must be {}", info.name, value, range)};
}

std::optional<Error> check_choice(const OptionInfo& info, std::size_t value) {
  if (value < info.choices.size() && !info.choices[value].empty()) return std::nullopt;
  std::vector<std::string_view> offered;
  for (const std::string_view word : info.choices)
    if (!word.empty()) offered.push_back(word);
  return Error{ErrorCode::usage, fmt::format("`{}` must be one of: {}", info.name, fmt::join(offered, ", "))};
}

std::optional<Error> check_word(const OptionInfo& info, const std::string& value) {
  const auto& words = info.choices;
  if (words.empty() || std::find(words.begin(), words.end(), value) != words.end()) return std::nullopt;
  return Error{ErrorCode::usage,
               fmt::format("`{}` is '{}'; it must be one of: {}", info.name, value, fmt::join(words, ", "))};
}

std::optional<Error> check_direction(const OptionInfo& info, const Eigen::Vector3d& value) {
  if (value.allFinite() && value.norm() > 0) return std::nullopt;
  return Error{ErrorCode::usage, fmt::format("`{}` is {},{},{}; it must be finite and not all zero",
                                             info.name, value.x(), value.y(), value.z())};
}

}  // namespace rfsmooth::detail
