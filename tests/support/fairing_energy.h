/// What divided differences weigh (smoothing/operators/divided_difference.h).
#pragma once

#include "smoothing/operators/divided_difference.h"

namespace rfsmooth::support {

/// x . A y.
inline double form(const smoothing::DividedDifferences& a, const Positions& x, const Positions& y) {
  Positions ay;
  a.apply(y, ay, {});
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i].dot(ay[i]);
  return sum;
}

/// E(x) = x . A x.
inline double energy(const smoothing::DividedDifferences& a, const Positions& x) {
  return form(a, x, x);
}

}  // namespace rfsmooth::support
