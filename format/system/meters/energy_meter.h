/// Energy of this host's processors, from the counters of Linux's powercap interface.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace gigabake {

/// A meter of the energy since its construction. Linux lets only some users read the counters.
/// Source  Linux, Documentation/power/powercap/powercap.rst.
class EnergyMeter {
 public:
  /// `root` is the root of the file system, for tests.
  explicit EnergyMeter(const std::filesystem::path& root = "/");

  /// Returns the joules of all packages; nullopt if no counter is readable. A counter that wraps more than once between
  /// two readings would be too low; it wraps after several minutes at least.
  std::optional<double> joules();

 private:
  struct Package {
    std::filesystem::path counter;
    std::uint64_t range_uj, latest_uj, sum_uj;
  };
  std::vector<Package> packages_;
};

}  // namespace gigabake
