#include "smoothing/partners.h"

namespace rfsmooth::smoothing {

std::vector<Partner> partners(const FlowOptions& options) {
  std::vector<Partner> all;
  if (const auto* o = std::get_if<LaplacianOptions>(&options.flow))
    all.push_back({"alpha", "`anchor` centre or `anchor` original", o->anchor != Anchor::none,
                   o->alpha != LaplacianOptions().alpha});
  if (const auto* o = std::get_if<DirectionalOptions>(&options.flow))
    all.push_back({"power", "`direction` auto", !o->direction, o->power != DirectionalOptions().power});
  const Modifiers standard, &m = options.modifiers;
  all.push_back({"push-alpha", "`push-back`", m.push_back, m.push_alpha != standard.push_alpha});
  all.push_back({"push-beta", "`push-back`", m.push_back, m.push_beta != standard.push_beta});
  all.push_back({"threshold-value", "`threshold` constant", m.threshold == ThresholdKind::constant,
                 m.threshold_value != standard.threshold_value});
  all.push_back({"threshold-every", "`threshold` one-ring or `threshold` two-ring",
                 m.threshold == ThresholdKind::one_ring || m.threshold == ThresholdKind::two_ring,
                 m.threshold_every != standard.threshold_every});
  return all;
}

}  // namespace rfsmooth::smoothing
