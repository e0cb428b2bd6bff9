/// Non-negative numbers as whole numbers in the same order: for atomics and for keys of several parts. Thread
/// safe.
#pragma once

#include <cstdint>
#include <cstring>

namespace rfsmooth::rfs_mesh {

/// The bits of a number from 0 on, as a whole number: they order as the numbers do (IEEE 754).
inline std::uint64_t ordered_bits(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
/// The same in single precision.
inline std::uint32_t ordered_bits(float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

}  // namespace rfsmooth::rfs_mesh
