/// Numbers of threads that are to give what one gives.
#pragma once

#include <vector>

namespace rfsmooth::test {

/// Two, four and seven: fewer and more than there are cores, and a number that divides nothing evenly. The
/// thread sanitizer sees with four whether loops race, and takes fifty times as long; the bytes are compared
/// without it.
inline std::vector<int> several_threads() {
#ifdef __SANITIZE_THREAD__
  return {4};
#else
  return {2, 4, 7};
#endif
}

}  // namespace rfsmooth::test
