#include "scheduler/status/bake_status.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <sstream>
#include <unistd.h>

#include "core/base/error.h"

namespace gigabake {
namespace {

/// Returns a status in which every member differs from its default.
BakeStatus made_status() {
  BakeStatus s;
  s.state = BakeState::draining;
  s.reason = "no space \"left\" on\nthe disk";
  s.out = "/shared/out";
  s.host = "node1";
  s.pid = 4321;
  s.ranks = 3;
  s.started_s = 1700000000.125;
  s.updated_s = 1700000100.1;
  s.tiles_scanned = 7;
  s.tiles = 9;
  s.cells = {100, 10, 40, 2, 41, 5, 2, 6};
  s.voxels = 12345678901;
  s.bytes = 987654321;
  s.recent = {1.5, 2.25e6, 3.1e7};
  s.overall = {0.1, 0.2, 0.3};
  s.left_s = 12.75;
  s.read_s = 1.1;
  s.kernel_s = 2.2;
  s.write_s = 3.3;
  s.slowest = {{"c_1_2_3", 9.5, 2}, {"c_3_2_1", 0.1, {}}};
  s.failures = 30;
  s.first_failures = {{"cell c_0_0_0", "ä line"}, {"tile 3", "another"}};
  s.process_restarts = 4;
  s.workers_lost = 1;
  s.workers = {{0, "node1", false, 1700000001, {"c_5_5_5", "c_6_5_5"}}, {2, "node2", true, 1700000002.5, {}}};
  return s;
}

class OutFolder {
 public:
  OutFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "gigabake-status-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp " + name);
    path_ = name;
  }
  ~OutFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  OutFolder(const OutFolder&) = delete;
  OutFolder& operator=(const OutFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

TEST(BakeStatus, SurvivesJson) {
  EXPECT_EQ(status_from_json("f", to_json(made_status())), made_status());
  EXPECT_EQ(status_from_json("f", to_json(BakeStatus{})), BakeStatus{});
  EXPECT_EQ(to_json(made_status()).find('\n'), std::string::npos) << "one line";
}

TEST(BakeStatus, SurvivesJsonInEveryState) {
  for (auto state = BakeState::scanning; state <= BakeState::failed; state = BakeState(int(state) + 1)) {
    BakeStatus s = made_status();
    s.state = state;
    EXPECT_EQ(status_from_json("f", to_json(s)), s) << name_of(state);
  }
}

TEST(BakeStatus, ReplacesBytesThatAreNoText) {
  BakeStatus s;
  s.first_failures = {{"tile \xff\xfe.glb", "x"}};
  const BakeStatus back = status_from_json("f", to_json(s));
  EXPECT_THAT(back.first_failures.at(0).name, testing::StartsWith("tile "));
  EXPECT_THAT(back.first_failures.at(0).name, testing::EndsWith(".glb"));
}

TEST(BakeStatus, RefusesWhatIsNoStatusInOneLineThatNamesTheFile) {
  const std::string good = to_json(made_status());
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"\"state\":\"draining\"", "\"state\":\"dreaming\""},
      {"\"pid\":4321", "\"pid\":-1"},
      {"\"pid\":4321", "\"pid\":1e300"},
      {"\"ranks\":3", "\"ranks\":99999999999"},
      {"\"planned\":100", "\"planned\":1.5"},
      {"\"voxels\":12345678901", "\"voxels\":\"many\""},
      {"\"lost\":true", "\"lost\":1"},
      {"\"left_s\":12.75", "\"left_s\":[]"},
      {"\"workers\":[", "\"workers\":[3,"},
      {"\"cells\":[\"c_5_5_5\"", "\"cells\":[{}"},
      {"\"host\":\"node1\",", ""},
      {"\"tiles\":{", "\"tiles\":{\"x\":{"}};
  for (const auto& [from, to] : changes) {
    std::string bad = good;
    ASSERT_NE(bad.find(from), std::string::npos) << from;
    bad.replace(bad.find(from), from.size(), to);
    try {
      status_from_json("OUT/status.json", bad);
      FAIL() << to;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::StartsWith("OUT/status.json: "));
      EXPECT_THAT(e.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }
}

TEST(BakeStatus, RefusesEveryCutAndSurvivesEveryFlippedByte) {
  const std::string good = to_json(made_status());
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_THROW(status_from_json("f", good.substr(0, length)), InputError) << length;
  constexpr unsigned seed = 83;
  std::mt19937 random(seed);
  for (int i = 0; i < 3000; ++i) {
    std::string bad = good;
    bad[random() % bad.size()] ^= char(1u << random() % 8);
    try {
      status_from_json("f", bad);
    } catch (const InputError&) {
    } catch (const std::exception& e) {
      FAIL() << "seed " << seed << ", try " << i << ": " << e.what();
    }
  }
}

TEST(BakeStatus, RefusesDeepNestingAndForeignJson) {
  for (const std::string& text :
       {std::string(100000, '['), std::string(), std::string("null"), std::string("[]"), std::string("{}"),
        std::string("{\"state\":null}"), std::string(1000, '\0'), std::string("1e999")})
    EXPECT_THROW(status_from_json("f", text), InputError) << text.substr(0, 20);
}

TEST(BakeStatus, IsPublishedWholeAndReadBack) {
  const OutFolder out;
  EXPECT_THROW(read_status(out.path()), InputError);
  write_status(out.path(), {});
  write_status(out.path(), made_status());
  EXPECT_EQ(read_status(out.path()), made_status());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out.path()), {}), 1) << "no temporary file is left";
}

TEST(BakeStatus, RefusesAFileTooLargeToBeAStatus) {
  const OutFolder out;
  std::ofstream(status_file(out.path())) << "{}";
  std::filesystem::resize_file(status_file(out.path()), std::uintmax_t(65) << 20);
  EXPECT_THROW(read_status(out.path()), InputError);
}

TEST(BakeStatusMetrics, AreWhatPrometheusReads) {
  BakeStatus s = made_status();
  s.out = "/a\\b\"c\nd";
  const std::string text = to_prometheus(s);
  EXPECT_THAT(text, testing::HasSubstr("\ngigabake_cells{bake=\"/a\\\\b\\\"c\\nd\",state=\"pending\"} 40\n"));
  EXPECT_THAT(text, testing::HasSubstr("\ngigabake_voxels_written_total{bake=\"/a\\\\b\\\"c\\nd\"} 12345678901\n"));
  std::map<std::string, int> described;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# ")) {
      ++described[line.substr(7, line.find(' ', 7) - 7)];
      continue;
    }
    const std::string metric = line.substr(0, line.find('{'));
    EXPECT_EQ(described[metric], 2) << "HELP and TYPE come before " << line;
    EXPECT_NO_THROW(std::stod(line.substr(line.rfind(' ') + 1))) << line;
  }
  EXPECT_EQ(text.back(), '\n');
}

TEST(BakeStatusMetrics, LeaveOutATimeThatNobodyKnows) {
  BakeStatus s = made_status();
  EXPECT_THAT(to_prometheus(s), testing::HasSubstr("gigabake_left_seconds{"));
  s.left_s.reset();
  EXPECT_THAT(to_prometheus(s), testing::Not(testing::HasSubstr("gigabake_left_seconds")));
}

}  // namespace
}  // namespace gigabake
