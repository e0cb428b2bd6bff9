/// Whether this is a build with the sanitizers, in which everything takes ten times as long: tests that ask
/// how well something works, at a size that this takes, ask it there of fewer points.
#pragma once

namespace rfsmooth::test {

#ifdef __SANITIZE_ADDRESS__
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace rfsmooth::test
