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
  return Error{ErrorCode::usage, fmt::format("--{} is {}; it must be {}", info.name, value, range)};
}

std::optional<Error> check_choice(const OptionInfo& info, const std::string& value) {
  if (info.choices.empty() ||
      std::find(info.choices.begin(), info.choices.end(), value) != info.choices.end())
    return std::nullopt;
  return Error{ErrorCode::usage, fmt::format("--{} is '{}'; it must be one of: {}", info.name, value,
                                             fmt::join(info.choices, ", "))};
}

}  // namespace rfsmooth::detail
