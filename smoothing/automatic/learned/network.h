/// The learned function: a small network that is odd in the normal, and its weights (weights.cpp, generated).
///
///     a+- = W_e x_even +- W_o x_odd + b,  y+- = v . phi(U phi(a+-) + c),  result = (y+ - y-) / 2
///
/// phi(t) = max(t, 0.1 t); features are centred (the even ones), scaled and clipped to +-6 beforehand. To
/// turn the normal round changes the sign of x_odd, and so that of the result. Sums are of single precision
/// in a fixed order, without a library's functions: the same bits for any number of threads and on every
/// machine whose floats are IEEE's.
#pragma once

#include <array>

#include "smoothing/automatic/learned/features.h"
#include "smoothing/automatic/learned/weights.h"

namespace rfsmooth::smoothing {

/// The network with its weights unpacked: 66 KB. Const functions are thread safe.
class Network {
 public:
  Network();

  /// How far along the normal from P the surface is, units of s. 23,000 multiplications.
  float offset(const Features::Row& row) const;

 private:
  static constexpr std::size_t kInputs = learned::kInputs;
  static_assert(kInputs == Features::kEven + Features::kOdd);
  using First = std::array<float, learned::kFirst>;
  using Second = std::array<float, learned::kSecond>;

  void through_first(const Features::Row& row, First& one, First& other) const;  ///< a+ and a-
  float behind(const First& first) const;                                        ///< y of one of them

  std::array<First, kInputs> first_;            ///< by input
  std::array<Second, learned::kFirst> second_;  ///< by unit of the first layer
  Second last_;
};

}  // namespace rfsmooth::smoothing
