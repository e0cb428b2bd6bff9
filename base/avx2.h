/// Functions compiled twice: for processors with registers of 256 bits (AVX2), and for all. The program takes
/// the first where it can. Both give the same bits: the compiler may not contract a product and a sum.
///
/// Not for public headers, nor for functions that take or return such vectors by value: how these are passed
/// depends on the processor. What they call must be inline, else it is compiled for all processors only.
#pragma once

#if defined(__x86_64__) && defined(__ELF__) && !defined(__SANITIZE_THREAD__)  // the choice runs before it
#define RFSMOOTH_AVX2 __attribute__((target_clones("avx2", "default")))
#else
#define RFSMOOTH_AVX2
#endif
