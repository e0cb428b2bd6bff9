/// Options that have a meaning only beside another option.
#pragma once

#include <string_view>
#include <vector>

#include <rfsmooth/flow_options.h>

namespace rfsmooth::smoothing {

/// Such an option, and the one it needs.
struct Partner {
  std::string_view option;   ///< its name in the tables
  std::string_view partner;  ///< what it needs, as messages say it
  bool on;                   ///< whether `partner` is set so
  bool set;                  ///< whether the option has another value than its default
};

/// Those of the chosen flow and of the modifiers. Thread safe.
std::vector<Partner> partners(const FlowOptions& options);

}  // namespace rfsmooth::smoothing
