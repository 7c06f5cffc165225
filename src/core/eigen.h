// Eigen, without fused multiply-add: on ARM its packets would use it whatever the compiler was told, and sums
// would have other bits than elsewhere. Before any other header of Eigen's.
#pragma once

#ifdef __aarch64__
#include <arm_neon.h>
#undef __ARM_FEATURE_FMA
#endif

#include <Eigen/Core>
