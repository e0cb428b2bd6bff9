#include "smoothing/partners.h"

#include <fmt/format.h>

namespace rfsmooth::smoothing {

namespace {

/// One option and whether its partner is on.
template <class T>
void settle(const std::optional<T>& given, std::optional<T>& full, bool on, const char* name,
            const char* partner) {
  if (on) return;
  if (given) throw Failure({ErrorCode::usage, fmt::format("--{} has no effect without {}", name, partner)});
  full.reset();
}

}  // namespace

void settle_partners(const FlowOptions& given, FlowOptions& full) {
  settle(given.alpha, full.alpha, !full.anchor || *full.anchor != "none", "alpha",
         "--anchor centre or --anchor original");
  settle(given.power, full.power, !full.direction || *full.direction == "auto", "power", "--direction auto");
  settle(given.push_alpha, full.push_alpha, *full.push_back, "push-alpha", "--push-back");
  settle(given.push_beta, full.push_beta, *full.push_back, "push-beta", "--push-back");
  settle(given.threshold_value, full.threshold_value, *full.threshold == "constant", "threshold-value",
         "--threshold constant");
  settle(given.threshold_every, full.threshold_every,
         *full.threshold == "one-ring" || *full.threshold == "two-ring", "threshold-every",
         "--threshold one-ring or --threshold two-ring");
}

}  // namespace rfsmooth::smoothing
