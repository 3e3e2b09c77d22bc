/// Random numbers and noise for the sample terrain.
///
/// Exact   Only integer hashes and IEEE double with + - * / sqrt and floor: the same bits on every machine. No function
///         calls libm, whose results differ between versions in the last digit.
#pragma once

#include <cstdint>

namespace gigabake::sample {

/// Returns a well-mixed 32-bit hash of the three values.
std::uint32_t hash_of(std::uint32_t seed, std::int32_t x, std::int32_t y = 0);

/// Converts a hash to a number between 0 and 1.
/// Range   [0, 1).
inline double unit(std::uint32_t hash) { return hash * (1.0 / 4294967296.0); }

inline double lerp(double a, double b, double t) { return a + (b - a) * t; }
inline double clamp01(double t) { return t < 0 ? 0 : t > 1 ? 1 : t; }

/// Returns 0 at `from` and 1 at `to`, with a smooth transition that has zero slope at both ends. `from` may exceed
/// `to`.
double smooth_step(double from, double to, double x);

/// Returns smooth lattice noise of wavelength 1.
/// Range   Within [-1, 1], mostly within [-0.5, 0.5].
double noise(std::uint32_t seed, double x, double y);

/// Returns a sum of octaves of noise, each of half the wavelength and half the amplitude of the previous one.
/// Range   See noise().
double fractal_noise(std::uint32_t seed, double x, double y, int octaves);

/// Returns a sum of octaves of 1 - |noise|: crests are sharp, hollows are wide.
/// Range   [0, 1].
double ridged_noise(std::uint32_t seed, double x, double y, int octaves);

/// A sequence of random numbers determined by its seed.
class Random {
 public:
  explicit Random(std::uint32_t seed) : seed_(seed) {}
  std::uint32_t next() { return hash_of(seed_, count_++, 0x5bd1); }
  double between(double low, double high) { return low + (high - low) * unit(next()); }
  int below(int end) { return int(unit(next()) * end); }

 private:
  std::uint32_t seed_;
  std::int32_t count_ = 0;
};

}  // namespace gigabake::sample
