#include "format/system/meters/energy_meter.h"

#include <fstream>
#include <string>
#include <system_error>

namespace gigabake {
namespace {

std::optional<std::uint64_t> number_in(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::uint64_t number = 0;
  if (!(in >> number)) return std::nullopt;
  return number;
}

/// Returns true for "intel-rapl:0", a package, but not for its part "intel-rapl:0:1", which the package includes.
bool is_package(const std::string& zone) {
  const std::size_t colon = zone.find(':');
  return zone.starts_with("intel-rapl:") && zone.find(':', colon + 1) == std::string::npos;
}

}  // namespace

EnergyMeter::EnergyMeter(const std::filesystem::path& root) {
  std::error_code error;
  for (const auto& zone : std::filesystem::directory_iterator(root / "sys/class/powercap", error)) {
    if (!is_package(zone.path().filename().string())) continue;
    const auto now = number_in(zone.path() / "energy_uj"), range = number_in(zone.path() / "max_energy_range_uj");
    if (now && range) packages_.push_back({zone.path() / "energy_uj", *range, *now, 0});
  }
}

std::optional<double> EnergyMeter::joules() {
  if (packages_.empty()) return std::nullopt;
  double sum_j = 0;
  for (Package& package : packages_) {
    const std::uint64_t now = number_in(package.counter).value_or(package.latest_uj);
    package.sum_uj += now >= package.latest_uj ? now - package.latest_uj : package.range_uj - package.latest_uj + now;
    package.latest_uj = now;
    sum_j += 1e-6 * double(package.sum_uj);
  }
  return sum_j;
}

}  // namespace gigabake
