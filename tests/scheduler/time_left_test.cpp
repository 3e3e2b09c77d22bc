/// Replayed bakes: compares the estimated remaining time with the actual one.
#include "scheduler/status/time_left.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

namespace gigabake {
namespace {

struct Replay {
  std::size_t workers = 1, parts = 1;
  double first_s = 1;              ///< until a worker's first part has ended; all others take a second
  std::vector<double> slowness{};  ///< of each part, about 1; empty: all parts take the same time
};

struct End {
  double at_s;
  std::size_t worker, part;
  bool is_last = false;  ///< whether it is the worker's last part
};

/// Returns the ends of all parts in order of time. An idle worker takes the next part at once.
std::vector<End> ends_of(const Replay& r) {
  std::vector<double> free_s(r.workers, r.first_s - 1);
  std::vector<End> ends;
  for (std::size_t part = 0; part < r.parts; ++part) {
    const auto next = std::size_t(std::ranges::min_element(free_s) - free_s.begin());
    free_s[next] += r.slowness.empty() ? 1 : r.slowness[part];
    ends.push_back({free_s[next], next, part});
  }
  std::ranges::stable_sort(ends, {}, &End::at_s);
  for (std::size_t worker = 0; worker < r.workers; ++worker)
    std::ranges::find(ends.rbegin(), ends.rend(), worker, &End::worker)->is_last = true;
  return ends;
}

struct Band {
  double minimum = 1e9, maximum = 0;  ///< bounds of estimate / actual time
  std::size_t estimates = 0;
};

/// Returns the bounds of the estimates, which are made ten times per second until a tenth of the time is left.
Band replay(const Replay& r) {
  const std::vector<End> ends = ends_of(r);
  const double all_s = ends.back().at_s;
  TimeLeft left;
  for (std::size_t worker = 0; worker < r.workers; ++worker) left.begins(worker, 0);
  Band band;
  std::size_t next = 0;
  for (double now_s = 0; now_s < 0.9 * all_s; now_s += 0.1) {
    for (; next < ends.size() && ends[next].at_s <= now_s; ++next) {
      left.ends(ends[next].worker, 1, ends[next].at_s);
      if (ends[next].is_last) left.rests(ends[next].worker);
    }
    const auto told_s = left.left_s(double(r.parts - next), now_s);
    if (!told_s) continue;
    band.minimum = std::min(band.minimum, *told_s / (all_s - now_s));
    band.maximum = std::max(band.maximum, *told_s / (all_s - now_s));
    ++band.estimates;
  }
  return band;
}

void expect_band(const Replay& r, double minimum, double maximum, const std::string& what) {
  const Band band = replay(r);
  EXPECT_GT(band.estimates, r.parts / r.workers) << what;
  EXPECT_GE(band.minimum, minimum) << what;
  EXPECT_LE(band.maximum, maximum) << what;
}

// 2026-11-22: the time left rose until a cell ended and then fell, by a factor of two and more.
TEST(TimeLeft, IsRightThroughoutAnEvenBake) {
  for (const std::size_t workers : {1, 2, 7, 32})
    expect_band({workers, workers * 40}, 0.9, 1.1, std::to_string(workers) + " workers");
}

TEST(TimeLeft, StaysInANarrowBandWhereAFirstPartTakesLongerThanThoseThatFollow) {
  for (const double first_s : {2.0, 4.0})
    expect_band({4, 160, first_s}, 0.8, 1.6, "first after " + std::to_string(first_s));
}

/// 2026-11-22: the time left varied by a factor of two.
TEST(TimeLeft, StaysInANarrowBandInANoisyBake) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 dice(seed);
    std::lognormal_distribution<double> slowness(0, 0.5);
    Replay r{4, 400, 2};
    for (std::size_t part = 0; part < r.parts; ++part) r.slowness.push_back(slowness(dice));
    expect_band(r, 0.65, 1.5, "seed " + std::to_string(seed));
  }
}

TEST(TimeLeft, FallsSecondBySecondBetweenTwoEndsAndStaysWhenOneIsLate) {
  TimeLeft left;
  left.begins(0, 100);
  for (const double at_s : {110.0, 120.0, 130.0, 140.0}) left.ends(0, 1, at_s);
  EXPECT_NEAR(*left.left_s(5, 140), 50, 1e-9);
  EXPECT_NEAR(*left.left_s(5, 144), 46, 1e-9);
  EXPECT_NEAR(*left.left_s(5, 150), 40, 1e-9);
  EXPECT_NEAR(*left.left_s(5, 190), 40, 1e-9);
}

TEST(TimeLeft, CountsOnlyWorkersThatAreBusy) {
  TimeLeft left;
  for (const std::size_t worker : {0, 1}) {
    left.begins(worker, 0);
    for (const double at_s : {1.0, 2.0, 3.0, 4.0}) left.ends(worker, 10, at_s);
  }
  EXPECT_NEAR(*left.left_s(100, 4), 5, 1e-9);
  left.rests(1);
  EXPECT_NEAR(*left.left_s(100, 4), 10, 1e-9);
  left.begins(1, 60);  // the worker's idle time does not make it slow
  left.ends(1, 10, 61);
  EXPECT_NEAR(*left.left_s(100, 61), 4.5, 1e-9) << "the other has a part nearly done";
}

TEST(TimeLeft, IsSilentUntilThereIsEnoughToTell) {
  TimeLeft left;
  EXPECT_FALSE(left.left_s(1, 0));
  left.begins(0, 0);
  EXPECT_FALSE(left.left_s(1, 5));
  left.ends(0, 1, 5);
  EXPECT_FALSE(left.left_s(99, 5)) << "one of a hundred";
  EXPECT_TRUE(left.left_s(3, 5)) << "a quarter";
}

}  // namespace
}  // namespace gigabake
