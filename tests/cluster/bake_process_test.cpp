#include "cluster/process/bake_process.h"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <sys/wait.h>
#include <thread>

#include "bake_scene.h"
#include "cluster/dispatch/rank_baker.h"
#include "tests/random_seed.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

using Died = BakeProcess::Died;
using Baked = BakeProcess::Baked;
using Scanned = BakeProcess::Scanned;
using std::chrono::milliseconds;

class BakeProcessTest : public testing::Test {
 protected:
  void expect_same_voxels(const CellReport& report, const CellReport& expected) {
    EXPECT_EQ(report.outcome, CellOutcome::baked) << report.error;
    EXPECT_EQ(report.cell.name, expected.cell.name);
    EXPECT_EQ(report.cell.content_hash, expected.cell.content_hash);
    EXPECT_EQ(report.cell.voxels, expected.cell.voxels);
  }

  /// Compares the next baked cells with `expected`, in any order, because a process bakes several cells at once.
  void expect_next(BakeProcess& process, const std::vector<CellReport>& expected, std::uint32_t attempt) {
    std::vector<CellReport> reports;
    while (reports.size() < expected.size()) {
      const Baked baked = expect<Baked>(process);
      EXPECT_EQ(baked.attempt, attempt);
      reports.push_back(baked.report);
    }
    for (const CellReport& e : expected) {
      const auto found = std::ranges::find(reports, e.id, &CellReport::id);
      ASSERT_NE(found, reports.end()) << e.cell.name;
      expect_same_voxels(*found, e);
    }
  }

  /// Kills the process by `signal` with three cells in flight. The next process bakes them.
  void dies_of(int signal, const std::string& why) {
    BakeProcess process(scene.setup("out"), real_program());
    for (std::uint32_t i = 0; i < 3; ++i) process.submit(jobs[i], 1);
    ASSERT_TRUE(process.pid());
    ASSERT_EQ(::kill(*process.pid(), signal), 0);
    const Died died = expect<Died>(process);
    EXPECT_EQ(died.why.find(why), 0u) << died.why;
    ASSERT_EQ(died.cells.size(), 3u);
    EXPECT_EQ(process.in_flight(), 0u);
    EXPECT_FALSE(process.pid());
    const auto expected = scene.baked_here({jobs[0], jobs[1], jobs[2]}, "here");
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(died.cells[i].job.name, jobs[i].name);
      process.submit(died.cells[i].job, died.cells[i].attempt + 1);
    }
    expect_next(process, expected, 2);
  }

  const BakeScene scene;
  const std::vector<CellJob> jobs = scene.jobs();
};

TEST_F(BakeProcessTest, BakesWhatThePipelineBakesInThisProcess) {
  const auto expected = scene.baked_here(jobs, "here");
  ASSERT_GE(expected.size(), 25u);
  BakeProcess process(scene.setup("out"), real_program());
  for (const CellJob& job : jobs) process.submit(job, 1);
  EXPECT_EQ(process.in_flight(), jobs.size());
  expect_next(process, expected, 1);
  EXPECT_EQ(process.in_flight(), 0u);
  EXPECT_GT(process.peak_bytes(), std::uint64_t(1) << 20);
}

TEST_F(BakeProcessTest, ScansWhileItBakes) {
  BakeProcess process(scene.setup("out"), real_program());
  for (std::uint32_t i = 0; i < 4; ++i) process.scan(i), process.submit(jobs[i], 1);
  const WorkerSetup setup = scene.setup("");
  const SceneSources sources = scene.sources();
  std::size_t scans = 0, cells = 0;
  while (scans + cells < 8) {
    const BakeProcess::Event event = next_event(process);
    ASSERT_NE(event.index(), 2u) << std::get<Died>(event).why;
    if (const auto* scanned = std::get_if<Scanned>(&event)) {
      const TileScan here = scan_tile(sources, scanned->scan.tile, setup.parameters, ThreadPool(1));
      EXPECT_EQ(to_bytes(scanned->scan), to_bytes(here));
      ++scans;
    } else {
      EXPECT_EQ(std::get<Baked>(event).report.outcome, CellOutcome::baked);
      ++cells;
    }
  }
  EXPECT_EQ(scans, 4u);
}

TEST_F(BakeProcessTest, HandsBackWhatWasInHandWhenItIsKilled) {
  dies_of(SIGKILL, "killed by signal 9 (SIGKILL): perhaps the system ran out of memory");
}
TEST_F(BakeProcessTest, HandsBackWhatWasInHandWhenItCrashes) {
#ifdef __SANITIZE_ADDRESS__
  dies_of(SIGABRT, "killed by signal 6 (SIGABRT)");  // the sanitizer handles SIGSEGV itself
#else
  dies_of(SIGSEGV, "killed by signal 11 (SIGSEGV)");
#endif
}

TEST_F(BakeProcessTest, TakesAStoppedProcessForHungAndGoesOn) {
  BakeProcessOptions options = real_program();
  options.timeouts.no_progress_s = 2;
  BakeProcess process(scene.setup("out"), options);
  process.scan(0);
  expect<Scanned>(process);
  ASSERT_EQ(::kill(*process.pid(), SIGSTOP), 0);
  process.submit(jobs[0], 1);
  const Died died = expect<Died>(process);
  EXPECT_EQ(died.why, "hung: no CPU time for 2 s in cell " + jobs[0].name);
  ASSERT_EQ(died.cells.size(), 1u);
  process.submit(jobs[0], 2);
  EXPECT_EQ(expect<Baked>(process).report.outcome, CellOutcome::baked);
}

/// `bake` starts its process before MPI, with the device that it expects to request. A wrong expectation only costs
/// time.
TEST_F(BakeProcessTest, AProcessThatWasStartedEarlyScansAndBakes) {
  for (const DeviceRequest& expected : {DeviceRequest{}, DeviceRequest{Backend::cuda, {}, 1, 2}}) {
    auto early = start_early(expected, real_program());
    ASSERT_TRUE(early);
    const pid_t pid = early->pid();
    BakeProcess process(scene.setup("out"), real_program(), std::move(early));
    process.scan(0);
    EXPECT_TRUE(expect<Scanned>(process).scan.error.empty());
    EXPECT_EQ(process.pid(), pid);
    process.submit(jobs[0], 1);
    EXPECT_EQ(expect<Baked>(process).report.outcome, CellOutcome::baked);
    ASSERT_TRUE(process.device());
    EXPECT_EQ(process.device()->error, "") << "the device of the setup counts";
  }
}

TEST_F(BakeProcessTest, AProcessThatWasStartedEarlyAndDiedIsReplaced) {
  auto early = start_early({}, real_program());
  ASSERT_TRUE(early);
  early->kill();
  BakeProcess process(scene.setup("out"), real_program(), std::move(early));
  process.scan(0);
  EXPECT_EQ(expect<Died>(process).tiles, std::vector<std::uint32_t>{0});
  process.scan(0);
  EXPECT_TRUE(expect<Scanned>(process).scan.error.empty());
}

TEST_F(BakeProcessTest, ItsRankReportsTheDeviceOnceBeforeTheFirstCell) {
  BakeProcess process(scene.setup("out"), real_program());
  RankBaker baker(process);
  for (const std::uint32_t job : {0u, 1u}) {
    const std::vector<std::uint8_t> order = order_bytes(0, {jobs[job], 1});
    baker.handle(order);
  }
  std::vector<int> tags;
  const auto last = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (tags.size() < 3 && std::chrono::steady_clock::now() < last) {
    process.wait(milliseconds(20));
    while (const auto message = baker.answer()) tags.push_back(message->tag);
  }
  EXPECT_EQ(tags, (std::vector<int>{tag_device, tag_report, tag_report}));
}

TEST_F(BakeProcessTest, ChoosesNoDeviceBeforeACellMustBeBakedFromItsSource) {
  const auto stored = scene.baked_here({jobs[0], jobs[1]}, "out");
  const auto expected = scene.baked_here({jobs[2], jobs[3]}, "here");
  WorkerSetup setup = scene.setup("out");
  setup.device = {Backend::cuda, {1000}, 0, 1, true};  // no host has this device
  BakeProcess process(setup, real_program());
  for (const CellReport& e : stored) {
    process.submit(jobs[e.id], 1);
    expect_same_voxels(expect<Baked>(process).report, e);
  }
  ASSERT_TRUE(process.device());
  EXPECT_EQ(*process.device(), DeviceAnswer{}) << "cells of stored shards need none";
  process.submit(jobs[2], 1);
  const CellReport report = expect<Baked>(process).report;
  EXPECT_EQ(report.outcome, CellOutcome::failed);
  EXPECT_EQ(report.error, process.device()->error);
  EXPECT_NE(report.error, "");

  setup.device = {Backend::automatic, {}, 0, 1, true};
  BakeProcess other(setup, real_program());
  RankBaker baker(other);
  std::vector<CellReport> reports;
  DeviceAnswer told;
  for (const std::uint32_t job : {2u, 0u, 3u}) baker.handle(order_bytes(0, {jobs[job], 1}));
  const auto last = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (reports.size() < 3 && std::chrono::steady_clock::now() < last) {
    other.wait(milliseconds(20));
    while (const auto message = baker.answer()) {
      if (message->tag == tag_device) told = device_from_bytes(message->bytes);
      if (message->tag != tag_report) continue;
      reports.push_back(answer_from_bytes(message->bytes).report);
      EXPECT_TRUE(reports.back().id == jobs[0].id || told != DeviceAnswer{}) << "the choice precedes the cell";
    }
  }
  ASSERT_EQ(reports.size(), 3u);
  EXPECT_EQ(told, *other.device());
  for (const CellReport& e : expected) expect_same_voxels(*std::ranges::find(reports, e.id, &CellReport::id), e);
}

TEST_F(BakeProcessTest, ItsRankReportsAProcessThatNeverStarts) {
  BakeProcess process(scene.setup("out"), {scene.script("broken", "exit 7")});
  RankBaker baker(process);
  std::vector<Message> messages;
  const auto last = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  for (std::uint32_t deaths = 0; messages.size() < 4 && std::chrono::steady_clock::now() < last;) {
    if (process.in_flight() == 0) baker.handle(order_bytes(deaths, {jobs[0], 1}));
    process.wait(milliseconds(20));
    while (auto message = baker.answer()) {
      deaths += message->tag == tag_died;
      messages.push_back(std::move(*message));
    }
  }
  ASSERT_EQ(messages.size(), 4u);
  EXPECT_EQ(messages[2].tag, tag_device);
  EXPECT_EQ(device_from_bytes(messages[2].bytes).error, "the bake process ended during its start: exit code 7");
  for (const int death : {0, 1, 3}) EXPECT_EQ(messages[std::size_t(death)].tag, tag_died);
}

TEST_F(BakeProcessTest, AProgramThatCannotBeStartedEarlyIsReportedLater) {
  EXPECT_FALSE(start_early({}, {"/no/such/program"}));
}

/// Regression of 2026-11-22: all ranks waited for ever for a process that hung in its start, before it had a cell.
TEST_F(BakeProcessTest, TakesAProcessThatStopsBeforeItBeginsForHung) {
  BakeProcessOptions options;
  options.program = scene.script("asleep", "exec sleep 600");
  options.timeouts.no_progress_s = 2;
  BakeProcess process(scene.setup("out"), options);
  process.prepare();
  EXPECT_EQ(expect<Died>(process).why, "hung: no CPU time for 2 s in its start");
}

TEST_F(BakeProcessTest, EndsACellThatTakesTooLong) {
  BakeProcessOptions options;
  options.program = scene.script("busy", "while :; do :; done");
  options.timeouts.no_progress_s = 20;
  options.timeouts.cell_timeout_s = 2;
  BakeProcess process(scene.setup("out"), options);
  process.submit(jobs[3], 1);
  EXPECT_EQ(expect<Died>(process).why, "not done after 2 s: cell " + jobs[3].name);
}

TEST_F(BakeProcessTest, LeavesAnIdleProcessAlone) {
  BakeProcessOptions options = real_program();
  options.timeouts.no_progress_s = 1;
  BakeProcess process(scene.setup("out"), options);
  process.scan(0);
  expect<Scanned>(process);
  const auto pid = process.pid();
  const auto last = std::chrono::steady_clock::now() + milliseconds(2500);
  while (std::chrono::steady_clock::now() < last) {
    EXPECT_FALSE(process.poll());
    process.wait(milliseconds(20));
  }
  EXPECT_EQ(process.pid(), pid);
}

TEST_F(BakeProcessTest, TellsOfADeathWithNothingInHand) {
  BakeProcess process(scene.setup("out"), real_program());
  process.scan(0);
  expect<Scanned>(process);
  ASSERT_EQ(::kill(*process.pid(), SIGKILL), 0);
  const Died died = expect<Died>(process);
  EXPECT_TRUE(died.cells.empty() && died.tiles.empty());
}

TEST_F(BakeProcessTest, SurvivesAHostileFileAndNamesIt) {
  std::ofstream(scene.source() / "tile1.glb", std::ios::trunc) << std::string(1000000, '[');
  std::ofstream(scene.source() / "tile2.gltf") << std::string(1000000, '[');
  BakeProcess process(scene.setup("out"), real_program());
  int errors = 0;
  for (std::uint32_t t = 0; t < 5; ++t) process.scan(t);
  for (int i = 0; i < 5; ++i) errors += !expect<Scanned>(process).scan.error.empty();
  EXPECT_EQ(errors, 2);
}

TEST_F(BakeProcessTest, AnswersEveryRequestWithTheLineWhereItCannotBegin) {
  const auto refusal = [this](const WorkerSetup& setup) {
    BakeProcess process(setup, real_program());
    process.submit(jobs[0], 1);
    const std::string cell = expect<Baked>(process).report.error;
    process.scan(99);
    EXPECT_NE(expect<Scanned>(process).scan.error, "");
    return cell;
  };
  WorkerSetup setup = scene.setup("out");
  setup.sources = std::make_shared<const std::vector<std::uint8_t>>(setup.sources->begin(), setup.sources->end() - 1);
  EXPECT_NE(refusal(setup).find("sources"), std::string::npos);
  setup.sources = std::make_shared<const std::vector<std::uint8_t>>();
  EXPECT_NE(refusal(setup).find("sources"), std::string::npos);
  std::ofstream(scene.folder() / "file") << "in the way";
  EXPECT_NE(refusal(scene.setup("file")).find("cannot make the folder"), std::string::npos);
}

/// Regression of 2026-11-25: a rank with other options baked other voxels under the fingerprints of rank 0's options.
TEST_F(BakeProcessTest, RefusesACellWhoseFingerprintIsOfOtherParameters) {
  WorkerSetup setup = scene.setup("out");
  setup.parameters.surface = SurfaceRule::thin;
  BakeProcess process(setup, real_program());
  process.submit(jobs[0], 1);
  const Baked baked = expect<Baked>(process);
  EXPECT_EQ(baked.report.outcome, CellOutcome::refused);
  EXPECT_NE(baked.report.error.find("fingerprint"), std::string::npos) << baked.report.error;
  EXPECT_FALSE(std::filesystem::exists(scene.folder() / "out" / shard_path(jobs[0])));
}

/// Regression of 2026-11-25: if a process ended before its first request, the waiting tiles counted as failed.
TEST_F(BakeProcessTest, KnowsAProcessThatEndsBeforeItHasStarted) {
  BakeProcessOptions options;
  options.program = scene.script("broken", "exit 3");
  BakeProcess broken(scene.setup("out"), options);
  broken.scan(0);
  EXPECT_FALSE(expect<Died>(broken).has_started);
  BakeProcess process(scene.setup("out"), real_program());
  process.scan(0);
  expect<Scanned>(process);
  ASSERT_EQ(::kill(*process.pid(), SIGKILL), 0);
  EXPECT_TRUE(expect<Died>(process).has_started);
}

/// Regression of 2026-11-25: without /proc a bake repeated an impossible start for 90 s.
TEST_F(BakeProcessTest, EndsAtOnceWhereNoProcessCanEverBeStarted) {
  BakeProcessOptions options;
  options.program = "/proc/no/such/program";
  BakeProcess process(scene.setup("out"), options);
  try {
    process.prepare();
    ADD_FAILURE() << "no error";
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(std::string(e.what()),
              "cannot start /proc/no/such/program: No such file or directory; a bake needs /proc to be mounted");
  }
}

TEST_F(BakeProcessTest, ScansTilesWhereItCannotBakeCells) {
  std::ofstream(scene.folder() / "file") << "in the way";
  BakeProcess process(scene.setup("file"), real_program());
  process.submit(jobs[0], 1);
  EXPECT_NE(expect<Baked>(process).report.error, "");
  process.scan(0);
  EXPECT_EQ(expect<Scanned>(process).scan.error, "");
}

/// Keeps up to three cells in flight and kills processes at random moments.
TEST_F(BakeProcessTest, BakesEveryCellOnceHoweverOftenItIsKilled) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const auto here = scene.baked_here(jobs, "here");
  std::map<std::uint32_t, CellReport> expected, got;
  for (const CellReport& r : here) expected[r.id] = r;
  std::deque<BakeOrder> waiting;
  while (waiting.size() < 30) waiting.push_back({jobs[waiting.size() % jobs.size()], 1});
  for (std::size_t i = jobs.size(); i < waiting.size(); ++i) waiting[i].job.id += 1000;  // the same cells, other ids
  BakeProcess process(scene.setup("out"), real_program());
  int kills = 0, deaths = 0;
  bool just_died = false;
  while (got.size() < 30) {
    for (; process.in_flight() < 3 && !waiting.empty(); waiting.pop_front())
      process.submit(waiting.front().job, waiting.front().attempt);
    // The test seldom kills a process twice without a result in between, because the next start is then delayed.
    if (kills < 20 && (just_died ? rng() % 8 == 0 : rng() % 8 != 0)) {
      std::this_thread::sleep_for(std::chrono::microseconds(rng() % 20000));
      if (process.pid() && ::kill(*process.pid(), SIGKILL) == 0) ++kills;
    }
    const BakeProcess::Event event = next_event(process);
    just_died = std::holds_alternative<Died>(event);
    if (const auto* baked = std::get_if<Baked>(&event)) {
      EXPECT_TRUE(got.emplace(baked->report.id, baked->report).second) << "twice";
    } else {
      const Died& died = std::get<Died>(event);
      ++deaths;
      for (const BakeOrder& order : died.cells) waiting.push_back({order.job, order.attempt + 1});
    }
  }
  for (const auto& [id, report] : got) {
    expect_same_voxels(report, expected.at(id % 1000));
  }
  EXPECT_GT(deaths, 5);
  RecordProperty("deaths", deaths);
  EXPECT_LE(deaths, kills);
}

}  // namespace
}  // namespace gigabake
