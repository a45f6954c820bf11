#pragma once

#include "core/rbf/radial_kernel.h"

namespace spinaltap::test {

inline constexpr RadialKernel kKernels[] = {RadialKernel::biharmonic, RadialKernel::triharmonic};

}  // namespace spinaltap::test
