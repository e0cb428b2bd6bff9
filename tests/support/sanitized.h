/// Whether this is a build with a sanitizer, in which everything takes ten times as long: tests that ask
/// how well something works, at a size that this takes, ask it there of fewer points.
#pragma once

namespace rfsmooth::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace rfsmooth::test
