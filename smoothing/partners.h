/// Options that mean something only beside another one.
#pragma once

#include <rfsmooth/flow.h>

namespace rfsmooth::smoothing {

/// Clears those of the `full` (completed) options whose partner is not on, so that completing them again
/// gives the same. \throw Failure (usage) naming the partner if one of them was `given`.
void settle_partners(const FlowOptions& given, FlowOptions& full);

}  // namespace rfsmooth::smoothing
