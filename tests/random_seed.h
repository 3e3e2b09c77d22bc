/// The seed of a test with random input. The default depends only on the name of the test, so that its result is the
/// same in every run. GIGABAKE_TEST_SEED=random, or a number, selects another seed; tools/random-tests sets it. A
/// failure while the object exists prints the seed. To repeat the failure, set GIGABAKE_TEST_SEED to the printed seed.
/// Errors  The test fails if GIGABAKE_TEST_SEED is neither a number nor `random`.
#pragma once

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>
#include <iostream>
#include <random>
#include <string>
#include <string_view>

namespace gigabake::test {

class RandomSeed {
 public:
  /// Creates seed number `round` of a test that uses several seeds.
  explicit RandomSeed(int round = 0) : RandomSeed(round, chosen()) {}

  operator std::uint64_t() const { return value_; }

 private:
  RandomSeed(int round, std::uint64_t chosen)
      : value_(chosen + std::uint64_t(round)), trace_(__FILE__, __LINE__, how_to_repeat(round, chosen)) {}

  static std::uint64_t chosen() {
    const char* wish = std::getenv("GIGABAKE_TEST_SEED");
    if (wish == nullptr) return seed_of(name_of_test());
    const std::string_view text(wish);
    std::uint64_t seed = std::random_device{}();
    if (text != "random") {
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
      if (error != std::errc{} || end != text.data() + text.size() || text.empty())
        ADD_FAILURE() << "GIGABAKE_TEST_SEED is \"" << text << "\": expected a number, or random";
    }
    // Printed immediately, because a test that crashes or hangs does not print a failure.
    std::cout << "GIGABAKE_TEST_SEED=" << seed << " in " << name_of_test() << std::endl;
    return seed;
  }

  static std::string name_of_test() {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    return std::string(test->test_suite_name()) + '.' + test->name();
  }

  static std::uint64_t seed_of(const std::string& name) {
    std::seed_seq letters(name.begin(), name.end());
    std::uint32_t seed = 0;
    letters.generate(&seed, &seed + 1);
    return seed;
  }

  static std::string how_to_repeat(int round, std::uint64_t chosen) {
    return "GIGABAKE_TEST_SEED=" + std::to_string(chosen) + (round == 0 ? "" : ", round " + std::to_string(round));
  }

  std::uint64_t value_;
  testing::ScopedTrace trace_;
};

}  // namespace gigabake::test
