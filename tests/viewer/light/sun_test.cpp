// The position of the sun compared with published values, and invalid times.
#include "viewer/light/sun.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "viewer/light/sky.h"

namespace gigabake {
namespace {

// Meeus 1998, "Astronomical Algorithms", example 25.a: 1992 October 13, 0h dynamical time.
TEST(Sun, StandsOnTheSkyWhereMeeusHasIt) {
  EXPECT_EQ(julian_day("1992-10-13T00:00Z"), 2448908.5);
  const SunOnSky sun = sun_on_sky(2448908.5);
  EXPECT_NEAR(sun.right_ascension_deg, 198.38083, 0.001);
  EXPECT_NEAR(sun.declination_deg, -7.78507, 0.001);
}

// Reda and Andreas 2003, "Solar Position Algorithm for Solar Radiation Applications" (NREL), example A.5.1.
TEST(Sun, StandsOverGoldenWhereTheNrelAlgorithmHasIt) {
  const SunDirection sun = sun_at({39.742476, -105.1786, 1830.14}, julian_day("2003-10-17T12:30:30-07:00"));
  EXPECT_NEAR(sun.azimuth_deg, 194.34024, 0.02);
  EXPECT_NEAR(sun.elevation_deg, 90 - 50.11162, 0.02);
}

TEST(Sun, StandsInTheZenithOfTheTropicAtTheSolsticeAndUnderThePoleInWinter) {
  EXPECT_GT(sun_at({23.4365, 0, 0}, julian_day("2026-06-21T12:02Z")).elevation_deg, 89.7);
  EXPECT_NEAR(sun_at({90, 0, 0}, julian_day("2026-12-21T12:00Z")).elevation_deg, -23.44, 0.02);
}

TEST(Sun, TimesOfOtherZonesAreTheSameTimes) {
  EXPECT_EQ(julian_day("2026-06-21T15:00Z"), julian_day("2026-06-21T17:00+02:00"));
  EXPECT_EQ(julian_day("2026-06-21T00:30:00Z"), julian_day("2026-06-20T19:30-05:00"));
}

TEST(Sun, TimesThatAreNoneAreRefused) {
  for (const char* time :
       {"", "2026", "2026-06-21", "2026-06-21T15:00", "2026-06-21 15:00Z", "2026-13-01T00:00Z", "2026-02-29T00:00Z",
        "2026-06-21T24:00Z", "2026-06-21T15:60Z", "2026-06-21T15:00:61Z", "2026-06-21T15:00Zulu", "2026-06-21T15:00+2",
        "2026-06-21T15:00+02:75", "1026-06-21T15:00Z", " 026-06-21T15:00Z", "2026-06-21T15:00:-1Z", "nan"})
    EXPECT_THROW(julian_day(time), UsageError) << time;
}

TEST(Sun, BelowTheHorizonLeavesTheSkyAloneAndTheSkyGrowsDarkerSteadily) {
  for (const double elevation : {0.0, -0.001, -30.0, -90.0}) {
    const kernels::CastLight light = daylight({0, elevation});
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(light.sun[k], 0) << elevation;
      EXPECT_GT(light.sky[k], 0) << elevation;
    }
  }
  for (int e = -90; e < 90; ++e) EXPECT_LE(daylight({0, double(e)}).sky[2], daylight({0, e + 1.0}).sky[2]) << e;
}

}  // namespace
}  // namespace gigabake
