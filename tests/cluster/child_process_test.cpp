#include "cluster/process/child_process.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "bake_scene.h"

namespace gigabake {
namespace {

using Died = BakeProcess::Died;
using Scanned = BakeProcess::Scanned;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

class ChildProcessTest : public testing::Test {
 protected:
  BakeProcessOptions misbehaving(const std::string& commands) const { return {scene.script("program", commands)}; }

  static std::string end_of(ChildProcess& child) {
    for (const auto last = Clock::now() + std::chrono::seconds(30); !child.ended() && Clock::now() < last;)
      std::this_thread::sleep_for(milliseconds(1));
    return child.ended().value_or("still there");
  }

  static void send(ChildProcess& child, const std::vector<std::uint8_t>& bytes) {
    ASSERT_EQ(::send(child.socket(), bytes.data(), bytes.size(), MSG_NOSIGNAL), ssize_t(bytes.size()));
  }

  /// Returns true if the process does not exist or is a zombie.
  static bool has_ended(pid_t pid) {
    std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
    const std::string text{std::istreambuf_iterator<char>(stat), {}};
    const std::size_t name_end = text.rfind(')');
    return name_end == std::string::npos || text.substr(name_end + 2, 1) == "Z";
  }

  static std::size_t open_files() {
    return std::size_t(std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}));
  }

  const BakeScene scene;
};

TEST_F(ChildProcessTest, EndsWhenItsSupervisorHangsUpEvenInTheMiddleOfAMessage) {
  ChildProcess child(GIGABAKE_PROGRAM, {"bake-process"});
  std::vector<std::uint8_t> part = frame(BakeMessageKind::setup, to_bytes(scene.setup("out")));
  for (int i = 0; i < 3; ++i) part.pop_back();
  send(child, part);
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_FALSE(child.ended());
  ASSERT_EQ(::shutdown(child.socket(), SHUT_WR), 0);
  EXPECT_EQ(end_of(child), "exit code 0");
}

TEST_F(ChildProcessTest, EndsWithALineWhereTheSupervisorTalksNonsense) {
  ChildProcess garbage(GIGABAKE_PROGRAM, {"bake-process"});
  send(garbage, std::vector<std::uint8_t>(100, 'x'));
  EXPECT_EQ(end_of(garbage), "exit code 1");
  ChildProcess early(GIGABAKE_PROGRAM, {"bake-process"});
  send(early, frame(BakeMessageKind::scan, scan_request(0)));
  EXPECT_EQ(end_of(early), "exit code 1");
  ChildProcess damaged(GIGABAKE_PROGRAM, {"bake-process"});
  std::vector<std::uint8_t> setup = frame(BakeMessageKind::setup, to_bytes(scene.setup("out")));
  setup.back() ^= 1;
  send(damaged, setup);
  EXPECT_EQ(end_of(damaged), "exit code 1");
}

TEST_F(ChildProcessTest, LeavesTheTerminalsSignalsToItsSupervisor) {
  BakeProcess process(scene.setup("out"), real_program());
  process.scan(0);
  expect<Scanned>(process);
  EXPECT_NE(::getpgid(*process.pid()), ::getpgid(0));
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGPIPE})
    ASSERT_EQ(::kill(*process.pid(), signal), 0);
  process.scan(1);
  expect<Scanned>(process);
}

TEST_F(ChildProcessTest, DiesWithItsSupervisor) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t supervisor = ::fork();
  ASSERT_GE(supervisor, 0);
  if (supervisor == 0) {
    BakeProcess process(scene.setup("out"), real_program());
    process.scan(0);
    while (!process.poll()) process.wait(milliseconds(10));
    const pid_t pid = *process.pid();
    if (::write(ends[1], &pid, sizeof pid) != ssize_t(sizeof pid)) ::_exit(1);
    for (;;) ::pause();
  }
  pid_t child = -1;
  ASSERT_EQ(::read(ends[0], &child, sizeof child), ssize_t(sizeof child));
  EXPECT_FALSE(has_ended(child));
  ASSERT_EQ(::kill(supervisor, SIGKILL), 0);
  ASSERT_EQ(::waitpid(supervisor, nullptr, 0), supervisor);
  for (const auto last = Clock::now() + std::chrono::seconds(10); !has_ended(child) && Clock::now() < last;)
    std::this_thread::sleep_for(milliseconds(1));
  EXPECT_TRUE(has_ended(child));
  ::close(ends[0]), ::close(ends[1]);
}

TEST_F(ChildProcessTest, GetsNeitherMpisVariablesNorOpenFiles) {
  for (const char* name : {"OMPI_TEST", "PMIX_TEST", "PMI_TEST", "PRTE_TEST", "GIGABAKE_TEST"})
    ASSERT_EQ(::setenv(name, "1", 1), 0);
  const std::filesystem::path out = scene.folder() / "seen", open = scene.folder() / "open_here";
  std::ofstream(open) << "x";
  const int fd = ::open(open.c_str(), O_RDONLY);  // a child must not inherit it
  ASSERT_GE(fd, 0);
  ChildProcess child(scene.script("look", "{ env | cut -d= -f1; ls -l /proc/$$/fd; } > " + out.string()),
                     {"bake-process"});
  EXPECT_EQ(end_of(child), "exit code 0");
  std::ifstream in(out);
  const std::string seen{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(seen.find("GIGABAKE_TEST"), std::string::npos) << seen;
  EXPECT_NE(seen.find("3 -> socket:"), std::string::npos) << seen;
  EXPECT_NE(seen.find("0 -> /dev/null"), std::string::npos) << seen;
  for (const char* kept : {"OMPI_", "PMIX_", "PMI_", "PRTE_", "open_here"})
    EXPECT_EQ(seen.find(kept), std::string::npos) << kept << " in " << seen;
  EXPECT_EQ(::close(fd), 0);
}

TEST_F(ChildProcessTest, LeaksNeitherFilesNorZombiesOverThirtyRestarts) {
  BakeProcess process(scene.setup("out"), real_program());
  process.scan(0);
  expect<Scanned>(process);
  const std::size_t before = open_files();
  for (int i = 0; i < 30; ++i) {
    ASSERT_EQ(::kill(*process.pid(), SIGKILL), 0);
    expect<Died>(process);
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
    process.scan(0);
    expect<Scanned>(process);
    EXPECT_EQ(open_files(), before);
  }
}

TEST_F(ChildProcessTest, GoesWithItsOwner) {
  pid_t pid = -1;
  {
    BakeProcess process(scene.setup("out"), misbehaving("trap '' TERM; exec sleep 1000"));
    process.scan(0);
    pid = *process.pid();
  }
  EXPECT_EQ(::kill(pid, 0), -1);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
}

TEST_F(ChildProcessTest, ThatNeverReadsBlocksNobody) {
  BakeProcess process(scene.setup("out"), misbehaving("exec sleep 1000"));
  CellJob job;
  job.tiles.resize(1000);
  const auto start = Clock::now();
  for (job.id = 0; job.id < 5000; ++job.id) process.submit(job, 1);
  while (Clock::now() < start + milliseconds(200)) EXPECT_FALSE(process.poll());
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(5));
  EXPECT_EQ(process.in_flight(), 5000u);
}

TEST_F(ChildProcessTest, ThatFloodsItsSupervisorIsEnded) {
  BakeProcess process(scene.setup("out"), misbehaving("exec cat /dev/zero >&3"));
  process.scan(2);
  const Died died = expect<Died>(process);
  EXPECT_EQ(died.why.find("sent an invalid message"), 0u) << died.why;
  EXPECT_EQ(died.tiles, std::vector<std::uint32_t>{2});
}

TEST_F(ChildProcessTest, ThatEndsAtOnceIsOneLineAndThenAPause) {
  BakeProcess process(scene.setup("out"), misbehaving("exit 5"));
  for (int i = 0; i < 3; ++i) {
    process.scan(0);
    EXPECT_EQ(expect<Died>(process).why, "exit code 5");
  }
  const auto third = Clock::now();
  process.scan(0);
  EXPECT_FALSE(process.poll());
  EXPECT_EQ(process.in_flight(), 1u);
  expect<Died>(process);
  EXPECT_GT(Clock::now() - third, milliseconds(900));
}

/// Regression of 2026-11-25: a process that could not be started was started again and again.
TEST_F(ChildProcessTest, ThatCannotBeStartedIsAnError) {
  BakeProcess process(scene.setup("out"), BakeProcessOptions{"/no/such/program"});
  try {
    process.scan(0);
    ADD_FAILURE() << "no error";
  } catch (const std::runtime_error& e) {
    EXPECT_EQ(std::string(e.what()), "cannot start /no/such/program: No such file or directory");
  }
}

}  // namespace
}  // namespace gigabake
