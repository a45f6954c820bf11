#pragma once

#include <gtest/gtest.h>

/// At the head of a test that would take minutes under sanitizers or with counters, and whose code others run there on
/// smaller bodies: it is skipped in instrumented builds.
#ifdef SPINALTAP_INSTRUMENTED
#define RELEASE_ONLY() GTEST_SKIP() << "takes too long in an instrumented build"
#else
#define RELEASE_ONLY() static_cast<void>(0)
#endif
