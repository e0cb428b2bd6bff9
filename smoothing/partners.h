/// Options that mean something only beside another one.
#pragma once

#include <string_view>
#include <vector>

#include <rfsmooth/flow_options.h>

namespace rfsmooth::smoothing {

/// One of them, and what it needs.
struct Partner {
  std::string_view option;   ///< its name in the tables
  std::string_view partner;  ///< what it needs, as messages say it
  bool on;                   ///< whether that is so
  bool set;                  ///< whether the option has another value than its default
};

/// Those of the flow that is chosen and of the modifiers. Thread safe.
std::vector<Partner> partners(const FlowOptions& options);

}  // namespace rfsmooth::smoothing
