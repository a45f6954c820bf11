#pragma once

#include "core/rbf/rbf_model.h"

namespace spinaltap::test {

inline constexpr RadialKernel kKernels[] = {RadialKernel::biharmonic, RadialKernel::triharmonic};

}  // namespace spinaltap::test
