#pragma once

// To be included before any header of Highway. Sizeless vectors (SVE, RISC-V) cannot be members of
// a struct, which the vector forms here rely on; those machines run the NEON or scalar target.
#ifdef BURNISH_FEW_TARGETS
// Sanitizers find in two of them what they find in all, and take minutes to compile each.
#define HWY_DISABLED_TARGETS                                                                     \
  (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | \
   HWY_AVX3_DL)
#else
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
