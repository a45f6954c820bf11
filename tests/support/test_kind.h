#pragma once

#include <initializer_list>

namespace spinaltap::test {

/// What not every run takes. Tests say it beside them.
enum class TestKind {
  slow,      ///< under sanitizers, only `./run sanitize all` runs them: others run the same code there, on less
  whole_run  ///< only `./run whole` runs them: they take a processor more than 20 s, or are the chain from end to end
};

/// Notes tests of this program, before main(). `patterns`: GoogleTest's, without the names of instances: "Suite.*".
class TestsOfKind {
 public:
  TestsOfKind(TestKind kind, std::initializer_list<const char*> patterns);
};

}  // namespace spinaltap::test

#define SPINALTAP_JOIN(a, b) a##b
#define SPINALTAP_TESTS_OF(kind, number, ...) \
  [[maybe_unused]] const ::spinaltap::test::TestsOfKind SPINALTAP_JOIN(tests_of_kind_, number)(kind, {__VA_ARGS__})
/// In an unnamed namespace; sources that are compiled as one may each have some.
#define SLOW_TESTS(...) SPINALTAP_TESTS_OF(::spinaltap::test::TestKind::slow, __COUNTER__, __VA_ARGS__)
#define WHOLE_RUNS(...) SPINALTAP_TESTS_OF(::spinaltap::test::TestKind::whole_run, __COUNTER__, __VA_ARGS__)
