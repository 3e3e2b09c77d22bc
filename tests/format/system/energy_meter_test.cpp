/// Energy from counters in a folder that the test writes.
#include "format/system/meters/energy_meter.h"

#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace gigabake {
namespace {

class EnergyMeterTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(zones_); }
  void TearDown() override { std::filesystem::remove_all(root_); }
  void write(const std::string& zone, const std::string& file, std::uint64_t number) const {
    std::filesystem::create_directories(zones_ / zone);
    std::ofstream(zones_ / zone / file) << number << "\n";
  }
  void write_zone(const std::string& zone, std::uint64_t energy_uj) const {
    write(zone, "energy_uj", energy_uj);
    write(zone, "max_energy_range_uj", 1000000);
  }

  const std::filesystem::path root_ =
      std::filesystem::temp_directory_path() / ("gigabake_energy_" + std::to_string(::getpid()));
  const std::filesystem::path zones_ = root_ / "sys/class/powercap";
};

TEST_F(EnergyMeterTest, SumsThePackagesWithoutTheirParts) {
  write_zone("intel-rapl:0", 100);
  write_zone("intel-rapl:1", 200);
  write_zone("intel-rapl:0:0", 50);
  EnergyMeter meter(root_);
  write_zone("intel-rapl:0", 500100);
  write_zone("intel-rapl:1", 250200);
  write_zone("intel-rapl:0:0", 400050);
  EXPECT_DOUBLE_EQ(meter.joules().value(), 0.75);
}

TEST_F(EnergyMeterTest, CountsOnAcrossAWrap) {
  write_zone("intel-rapl:0", 900000);
  EnergyMeter meter(root_);
  write_zone("intel-rapl:0", 100000);
  EXPECT_DOUBLE_EQ(meter.joules().value(), 0.2);
  write_zone("intel-rapl:0", 400000);
  EXPECT_DOUBLE_EQ(meter.joules().value(), 0.5);
}

TEST_F(EnergyMeterTest, HasNoValueWithoutReadableCounters) {
  EXPECT_EQ(EnergyMeter(root_).joules(), std::nullopt);
  EXPECT_EQ(EnergyMeter(root_ / "absent").joules(), std::nullopt);
  write("intel-rapl:0", "max_energy_range_uj", 5);
  EXPECT_EQ(EnergyMeter(root_).joules(), std::nullopt);
}

}  // namespace
}  // namespace gigabake
