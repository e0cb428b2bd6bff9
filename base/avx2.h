#pragma once

/// Before a function: compiles it twice, for processors with AVX2 and for all others. The loader picks the
/// version. Both give the same bits, because -ffp-contract=off forbids fused multiply-add.
///
/// Not for public headers, nor for functions that take or return AVX vectors by value: how these are passed
/// depends on the processor. Functions called from such a function must be inline; others exist in the
/// general version only.
#if defined(__x86_64__) && defined(__ELF__) && !defined(__SANITIZE_THREAD__)  // the loader runs before it
#define RFSMOOTH_AVX2 __attribute__((target_clones("avx2", "default")))
#else
#define RFSMOOTH_AVX2
#endif

/// The same with all that it calls inside, where the compiler can do both.
#if defined(__clang__)
#define RFSMOOTH_AVX2_FLAT RFSMOOTH_AVX2
#else
#define RFSMOOTH_AVX2_FLAT RFSMOOTH_AVX2 __attribute__((flatten))
#endif
