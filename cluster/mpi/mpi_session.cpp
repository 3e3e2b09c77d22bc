#include "cluster/mpi/mpi_session.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <list>
#include <mpi.h>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>

#include "cluster/launch/launcher.h"
#include "cluster/mpi/mpi_call_timeout.h"
#include "cluster/process/drain.h"
#include "cluster/process/host_cores.h"

namespace gigabake {
namespace {

/// Throws on an MPI error. After MPI_Init a call fails if the connection to another rank is lost.
void check(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw RankLost(std::string(call) + ": " + std::string(text, std::size_t(length)));
}

bool is_done(MPI_Request& request, const char* call) {
  int done = 0;
  check(MPI_Test(&request, &done, MPI_STATUS_IGNORE), call);
  return done != 0;
}

/// Polls the request at increasing intervals, so that a waiting rank uses about 1 % of a core.
void wait_for(MPI_Request& request, double collective_timeout_s, const char* call) {
  const auto start = std::chrono::steady_clock::now();
  for (auto pause = std::chrono::microseconds(20); !is_done(request, call);
       pause = std::min(pause * 2, std::chrono::microseconds(2000))) {
    std::this_thread::sleep_for(pause);
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > collective_timeout_s)
      throw RankLost(std::string(call) + ": not every rank answered within " +
                     std::to_string(std::int64_t(collective_timeout_s)) + " s; run the same command again");
  }
}

struct HostShare {
  int rank, ranks, cores;
};

/// Computes this rank's share of its host. Collective call.
HostShare share_of_host(int rank) {
  MPI_Comm host = MPI_COMM_NULL;
  int ranks_here = 0, rank_here = 0;
  check(MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank, MPI_INFO_NULL, &host), "MPI_Comm_split_type");
  check(MPI_Comm_size(host, &ranks_here), "MPI_Comm_size");
  check(MPI_Comm_rank(host, &rank_here), "MPI_Comm_rank");
  const CoreSet own = cores_of_this_process();
  std::vector<CoreSet> all(static_cast<std::size_t>(ranks_here));
  check(MPI_Allgather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, host), "MPI_Allgather");
  check(MPI_Comm_free(&host), "MPI_Comm_free");
  const HostLimits limits = host_limits();
  const int of_shared = std::max(1, limits.shared_cores / ranks_here);
  return {rank_here, ranks_here, std::min({fair_share(all, std::size_t(rank_here)), of_shared, limits.task_cores})};
}

std::int64_t reduce(std::int64_t value, MPI_Op operation, double collective_timeout_s) {
  std::int64_t result = value;
  MPI_Request request = MPI_REQUEST_NULL;
  check(MPI_Iallreduce(&value, &result, 1, MPI_INT64_T, operation, MPI_COMM_WORLD, &request), "MPI_Iallreduce");
  wait_for(request, collective_timeout_s, "MPI_Iallreduce");
  return result;
}

/// Configures Open MPI for a process without a launcher, a world of one rank. Open MPI then starts no daemon and does
/// not probe networks, which saves 0.3 s of 0.4 s. Variables that are already set stay. Other MPI libraries ignore
/// these variables.
void expect_no_other_ranks() {
  ::setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  // All processes without a launcher would share one folder below /tmp, which the first to end would remove.
  ::setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  ::setenv("OMPI_MCA_pml", "ob1", 0);
  ::setenv("OMPI_MCA_btl", "self", 0);
}

/// Min size of a message that MPI moves in many parts.
constexpr std::size_t large_message_bytes = std::size_t(1) << 17;

/// Returns until when a rank calls MPI at short intervals for a message whose transfer begins. MPI moves a part of a
/// large message per call, so each part would otherwise wait for the next poll(). The other rank may be suspended.
std::chrono::steady_clock::time_point end_of_transfer(std::size_t bytes) {
  constexpr std::size_t bytes_per_us = 100;
  return std::chrono::steady_clock::now() + std::chrono::milliseconds(10) +
         std::chrono::microseconds(bytes / bytes_per_us);
}
constexpr std::chrono::microseconds transfer_interval{20};

/// Moves a large message while the receiver takes it.
void move_large(MPI_Request& request, std::size_t bytes) {
  const auto end = end_of_transfer(bytes);
  while (!is_done(request, "MPI_Isend") && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(transfer_interval);
}

/// Broadcasts rank 0's bytes. Collective call.
void broadcast(void* bytes, std::size_t count, double collective_timeout_s) {
  MPI_Request request = MPI_REQUEST_NULL;
  check(MPI_Ibcast(bytes, int(count), MPI_BYTE, 0, MPI_COMM_WORLD, &request), "MPI_Ibcast");
  wait_for(request, collective_timeout_s, "MPI_Ibcast");
}

}  // namespace

/// Pending sends. The container is a list, because MPI keeps pointers to the bytes and the request.
struct MpiSession::Outbox {
  struct PendingSend {
    std::vector<std::uint8_t> bytes;
    MPI_Request request = MPI_REQUEST_NULL;
  };
  std::list<PendingSend> letters;

  void remove_sent() {
    letters.remove_if([](PendingSend& letter) { return is_done(letter.request, "MPI_Isend"); });
  }
};

/// Messages that are being received. A large message arrives in parts, for which its sender must call MPI; a call that
/// waited for a suspended sender would stop this rank, too.
struct MpiSession::Inbox {
  struct PendingReceive {
    Message message;
    MPI_Request request = MPI_REQUEST_NULL;
    std::chrono::steady_clock::time_point transfer_end;
  };
  std::list<PendingReceive> letters;

  /// Begins to receive all messages that have been announced.
  void begin_receives() {
    for (;;) {
      int arrived = 0, bytes = 0;
      MPI_Message matched = MPI_MESSAGE_NULL;
      MPI_Status status;
      check(MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &arrived, &matched, &status), "MPI_Improbe");
      if (arrived == 0) return;
      check(MPI_Get_count(&status, MPI_BYTE, &bytes), "MPI_Get_count");
      PendingReceive& letter = letters.emplace_back();
      letter.transfer_end = end_of_transfer(std::size_t(bytes));
      letter.message = {status.MPI_SOURCE, status.MPI_TAG, std::vector<std::uint8_t>(std::size_t(bytes))};
      check(MPI_Imrecv(letter.message.bytes.data(), bytes, MPI_BYTE, &matched, &letter.request), "MPI_Imrecv");
    }
  }

  /// Returns the next message, if one is complete soon.
  std::optional<Message> take() {
    for (;;) {
      if (auto message = take_complete()) return message;
      const auto now = std::chrono::steady_clock::now();
      if (std::ranges::none_of(letters, [now](const PendingReceive& l) { return now < l.transfer_end; })) return {};
      std::this_thread::sleep_for(transfer_interval);
    }
  }

 private:
  /// Returns the first complete message. Messages of one rank keep their order.
  std::optional<Message> take_complete() {
    std::set<int> incomplete;
    for (auto letter = letters.begin(); letter != letters.end(); ++letter) {
      if (!is_done(letter->request, "MPI_Imrecv")) incomplete.insert(letter->message.from);
      if (incomplete.contains(letter->message.from)) continue;
      std::optional<Message> message = std::move(letter->message);
      letters.erase(letter);
      return message;
    }
    return std::nullopt;
  }
};

MpiSession::MpiSession() : outbox_(std::make_unique<Outbox>()), inbox_(std::make_unique<Inbox>()) {
  end_if_mpirun_dies();  // before MPI_Init, in which a rank may hang
  const MpiCallTimeout bound(max_mpi_call_s(), "the start of MPI");
  ::setenv("HWLOC_COMPONENTS", hwloc_without_gpus, 0);
  if (!is_launched(environment_of_process)) expect_no_other_ranks();
  int provided = MPI_THREAD_SINGLE;
  check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided), "MPI_Init_thread");
  if (provided < MPI_THREAD_FUNNELED) throw std::runtime_error("MPI_Init_thread: this MPI has no MPI_THREAD_FUNNELED");
  check(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler");
  check(MPI_Comm_rank(MPI_COMM_WORLD, &rank_), "MPI_Comm_rank");
  check(MPI_Comm_size(MPI_COMM_WORLD, &ranks_), "MPI_Comm_size");
  const HostShare share = share_of_host(rank_);
  rank_on_host_ = share.rank;
  ranks_on_host_ = share.ranks;
  cores_ = share.cores;
}

int MpiSession::host_cores() const {
  return std::min(host_limits().shared_cores, int(std::max<long>(1, ::sysconf(_SC_NPROCESSORS_ONLN))));
}

MpiSession::~MpiSession() {
  const MpiCallTimeout bound(max_mpi_call_s(), "MPI_Finalize");
  MPI_Finalize();
}

void MpiSession::send(int to, int tag, std::vector<std::uint8_t> bytes) {
  if (bytes.size() > std::size_t(std::numeric_limits<int>::max()))
    throw std::runtime_error("a message to rank " + std::to_string(to) + " has more than 2 GiB");
  Outbox::PendingSend& letter = outbox_->letters.emplace_back();
  letter.bytes = std::move(bytes);
  check(MPI_Isend(letter.bytes.data(), int(letter.bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD, &letter.request),
        "MPI_Isend");
  if (letter.bytes.size() >= large_message_bytes) move_large(letter.request, letter.bytes.size());
}

void MpiSession::progress() { outbox_->remove_sent(); }

std::optional<Message> MpiSession::poll() {
  progress();
  inbox_->begin_receives();
  return inbox_->take();
}

std::int64_t MpiSession::max_of(std::int64_t value) { return reduce(value, MPI_MAX, collective_timeout_s_); }
std::int64_t MpiSession::sum_of(std::int64_t value) { return reduce(value, MPI_SUM, collective_timeout_s_); }

int MpiSession::from_master(int value) {
  broadcast(&value, sizeof value, collective_timeout_s_);
  return value;
}

std::vector<std::uint8_t> MpiSession::from_master(std::vector<std::uint8_t> bytes) {
  constexpr std::size_t part_bytes = std::size_t(1) << 28;  // MPI counts in int; the timeout applies to each part
  std::uint64_t size = bytes.size();
  broadcast(&size, sizeof size, collective_timeout_s_);
  bytes.resize(size);
  for (std::size_t at = 0; at < bytes.size(); at += part_bytes)
    broadcast(bytes.data() + at, std::min(part_bytes, bytes.size() - at), collective_timeout_s_);
  return bytes;
}

void MpiSession::abort(int exit_code) {
  const MpiCallTimeout bound(max_mpi_call_s(), "MPI_Abort");
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::abort();
}

}  // namespace gigabake
