#pragma once
// What Highway compiles loops for, before its foreach_target.h: AVX2, which smelt asks of any machine (Highway would
// start lower, as x86-64-v3 does not promise AES), and AVX-512. Sanitizers make do with AVX2, as builds of both take
// long: SMELT_AVX2_ONLY.

#define HWY_BASELINE_TARGETS HWY_AVX2
#ifdef SMELT_AVX2_ONLY
#define HWY_DISABLED_TARGETS (HWY_AVX3 | HWY_AVX3_DL)
#else
#define HWY_DISABLED_TARGETS HWY_AVX3_DL
#endif
