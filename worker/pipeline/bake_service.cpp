#include "worker/pipeline/bake_service.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/trace.h"
#include "format/job/fingerprint.h"
#include "format/job/run_work.h"
#include "format/job/source_bytes.h"
#include "format/system/meters/trace_file.h"
#include "worker/device/device_start.h"
#include "worker/pipeline/bake_messages.h"
#include "worker/pipeline/cell_pipeline.h"
#include "worker/pipeline/worker_setup.h"
#include "worker/scan/scan_tile.h"

namespace gigabake {
namespace {

[[noreturn]] void fail(const char* call) { throw std::system_error(errno, std::generic_category(), call); }

/// Wakeup of one polling thread by other threads.
class Wakeup {
 public:
  Wakeup() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (fd_ < 0) fail("eventfd");
  }
  ~Wakeup() { ::close(fd_); }
  Wakeup(const Wakeup&) = delete;
  Wakeup& operator=(const Wakeup&) = delete;
  int fd() const { return fd_; }
  void ring() const {
    if (::eventfd_write(fd_, 1) != 0 && errno != EAGAIN) fail("eventfd_write");  // EAGAIN: already signalled
  }
  void silence() const {
    eventfd_t rings = 0;
    if (::eventfd_read(fd_, &rings) != 0 && errno != EAGAIN) fail("eventfd_read");
  }

 private:
  int fd_;
};

/// Threads that scan tiles. Several small tiles are scanned concurrently, because most of the reading of a tile runs on
/// one thread.
class ScanThread {
 public:
  ScanThread(const SceneSources& sources, const WorkerSetup& setup, const Wakeup& done)
      : sources_(sources),
        parameters_(setup.parameters),
        pool_(setup.worker.threads),
        store_(sources, setup.parameters, scratch_in(setup.worker.scratch, setup.worker.memory_bytes),
               setup.worker.threads),
        done_(done) {
    for (int t = std::min(max_concurrent, setup.worker.threads); t > 0; --t) crew_.emplace_back([this] { run(); });
  }
  ~ScanThread() {
    {
      const std::scoped_lock lock(mutex_);
      stopping_ = true;
    }
    asked_.notify_all();
    for (std::thread& thread : crew_) thread.join();
  }
  ScanThread(const ScanThread&) = delete;
  ScanThread& operator=(const ScanThread&) = delete;

  void submit(std::uint32_t tile) {
    {
      const std::scoped_lock lock(mutex_);
      tiles_.push_back(tile);
    }
    asked_.notify_all();
  }

  std::optional<TileScan> poll() {
    const std::scoped_lock lock(mutex_);
    if (scans_.empty()) return std::nullopt;
    TileScan scan = std::move(scans_.front());
    scans_.pop_front();
    return scan;
  }

 private:
  std::optional<std::uint32_t> next_tile() {
    std::unique_lock lock(mutex_);
    asked_.wait(lock, [this] { return stopping_ || !tiles_.empty(); });
    if (stopping_) return std::nullopt;
    const std::uint32_t tile = tiles_.front();
    tiles_.pop_front();
    return tile;
  }

  TileScan scan(std::uint32_t tile) {
    std::unique_lock one_at_a_time(large_, std::defer_lock);
    if (sources_.tiles[tile].bytes > small_bytes || store_.may_be_large(tile)) one_at_a_time.lock();
    const TraceSpan span("scan");
    return scan_tile(sources_, tile, parameters_, pool_, &store_);
  }

  void run() {
    while (const auto tile = next_tile()) {
      TileScan scan = this->scan(*tile);
      {
        const std::scoped_lock lock(mutex_);
        scans_.push_back(std::move(scan));
      }
      done_.ring();
    }
  }

  static constexpr int max_concurrent = 4;
  /// Max size in bytes of a small tile file. Larger files are scanned one after the other, because several at once
  /// would multiply the process's memory.
  static constexpr std::uint64_t small_bytes = std::uint64_t(16) << 20;

  const SceneSources& sources_;
  const BakeParameters& parameters_;
  const ThreadPool pool_;
  const TileStore store_;
  const Wakeup& done_;
  std::mutex large_;  ///< held while a large tile is scanned
  std::mutex mutex_;
  std::condition_variable asked_;
  std::deque<std::uint32_t> tiles_;
  std::deque<TileScan> scans_;
  bool stopping_ = false;
  std::vector<std::thread> crew_;  ///< declared last, because the threads use the other members
};

/// An attempt at a cell, by the cell's id.
struct Attempt {
  std::uint32_t cell, number;
  bool returns_child;
};

class BakeServer {
 public:
  explicit BakeServer(int fd) : fd_(fd) {}

  int run() {
    while (receive()) {
      while (const auto message = inbox_.next()) handle(*message);
      answer();
      wait();
    }
    return 0;
  }

 private:
  void wait() const {
    std::array<pollfd, 2> ready{pollfd{fd_, POLLIN, 0}, pollfd{done_.fd(), POLLIN, 0}};
    if (::poll(ready.data(), ready.size(), -1) < 0 && errno != EINTR) fail("poll");
  }

  /// Reads all available bytes. Returns false if the peer closed the connection.
  bool receive() {
    std::array<std::uint8_t, 65536> part;
    while (!hung_up_) {
      const ssize_t got = ::recv(fd_, part.data(), part.size(), MSG_DONTWAIT);
      if (got > 0) inbox_.add(std::span(part).first(std::size_t(got)));
      if (got == 0 || (got < 0 && errno == ECONNRESET)) return false;
      if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return true;
      if (got < 0 && errno != EINTR) fail("recv");
    }
    return false;
  }

  void send(BakeMessageKind kind, const std::vector<std::uint8_t>& payload) {
    const std::vector<std::uint8_t> bytes = frame(kind, payload);
    for (std::size_t sent = 0; sent < bytes.size() && !hung_up_;) {
      const ssize_t now = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (now >= 0) sent += std::size_t(now);
      if (now < 0 && (errno == EPIPE || errno == ECONNRESET)) hung_up_ = true;
      if (now < 0 && !hung_up_ && errno != EINTR) fail("send");
    }
  }

  void handle(const BakeMessage& message) {
    const bool opens = message.kind == BakeMessageKind::setup || message.kind == BakeMessageKind::sources ||
                       message.kind == BakeMessageKind::device;
    if (opens == setup_.has_value())
      throw InputError("bake message", "kind", "expected one setup, before all requests");
    switch (message.kind) {
      case BakeMessageKind::device:
        return device_start_.begin(device_request_from_bytes(message.payload));
      case BakeMessageKind::sources:
        source_bytes_.insert(source_bytes_.end(), message.payload.begin(), message.payload.end());
        return;
      case BakeMessageKind::setup:
        return open(setup_from_bytes(message.payload));
      case BakeMessageKind::scan:
        return scan(tile_of_request(message.payload));
      case BakeMessageKind::bake:
        return bake(order_from_bytes(message.payload));
      default:
        throw InputError("bake message", "kind", "expected a request");
    }
  }

  /// Opens the sources. Tiles are scanned while the device starts on another thread.
  void open(WorkerSetup setup) {
    setup_ = std::move(setup);
    set_memory_limit(setup_->worker.memory_bytes);
    if (is_device_deferred())
      send(BakeMessageKind::ready, to_bytes(DeviceAnswer{}));
    else
      device_start_.begin(setup_->device);
    open_scene();
    send(BakeMessageKind::started, {});
  }

  /// Waits for the choice of the device and sends it to the supervisor. Makes the pipeline if it is not the CPU.
  void take_device() {
    device_start_.begin(setup_->device);
    is_device_taken_ = true;
    const DeviceAnswer& answer = device_start_.answer();
    if (!answer.error.empty()) why_not_ = answer.error;
    setup_->worker.cuda_device = answer.choice.device;
    // Kernels of ranks that share a device run one after the other. While one rank's kernels run, another rank may
    // therefore pack on the cores of all these ranks.
    if (setup_->worker.threads_are_a_share) setup_->worker.threads *= answer.choice.sharers;
    setup_->worker.device_bytes = setup_->worker.memory_is_default ? answer.choice.device_bytes : 0;
    send(BakeMessageKind::ready, to_bytes(answer));
    if (setup_->worker.cuda_device) make_pipeline();
  }

  void open_scene() {
    try {
      sources_ = sources_from_bytes(std::exchange(source_bytes_, {}));
      fingerprints_.emplace(setup_->parameters, sources_);
      scanner_ = std::make_unique<ScanThread>(sources_, *setup_, done_);
      scans_ = true;
    } catch (const std::exception& e) {
      why_not_ = reason_of(e);
    }
  }

  void scan(std::uint32_t tile) {
    if (scans_ && tile < sources_.tiles.size()) return scanner_->submit(tile);
    TileScan scan;
    scan.tile = tile;
    scan.error = scans_ ? "there is no tile " + std::to_string(tile) : why_not_;
    send(BakeMessageKind::scanned, to_bytes(scan));
  }

  /// Returns whether no cell has needed the device yet.
  bool is_device_deferred() const { return setup_->device.only_if_needed && !is_device_taken_; }

  std::unique_ptr<CellPipeline>& current_pipeline() { return is_device_deferred() ? stored_pipeline_ : pipeline_; }

  void make_pipeline() {
    std::unique_ptr<CellPipeline>& pipeline = current_pipeline();
    if (pipeline || !why_not_.empty()) return;
    WorkerOptions options = setup_->worker;
    options.stored_only = is_device_deferred();
    try {
      pipeline = std::make_unique<CellPipeline>(sources_, setup_->parameters, options, [this] { done_.ring(); });
    } catch (const std::exception& e) {
      why_not_ = reason_of(e);
    }
  }

  void bake(BakeOrder order) {
    if (!is_device_deferred() && !is_device_taken_) take_device();
    make_pipeline();
    CellPipeline* const pipeline = current_pipeline().get();
    if (pipeline != nullptr && !fingerprints_->match(order.job))
      return answer_without_shard(order, CellOutcome::refused,
                                  "its fingerprint does not match the parameters of this process");
    if (pipeline != nullptr) {
      attempts_.push_back({order.job.id, order.attempt, order.returns_child});
      for (const ChildBytes& child : order.children)
        pipeline->keep_child(child.file, overview_child_from_bytes(child.bytes));
      return pipeline->submit(std::move(order.job));
    }
    answer_without_shard(order, CellOutcome::failed, why_not_);
  }

  /// Bakes a cell that no stored shard makes. All later orders go to the same pipeline.
  void bake_from_source(CellJob job) {
    if (!is_device_taken_) take_device();
    make_pipeline();
    if (pipeline_) return pipeline_->submit(std::move(job));
    const Attempt attempt = take_attempt(job.id);
    answer_without_shard({std::move(job), attempt.number}, CellOutcome::failed, why_not_);
  }

  /// Removes and returns the oldest attempt at a cell, because the cell may have been requested again.
  Attempt take_attempt(std::uint32_t cell) {
    const auto found = std::ranges::find(attempts_, cell, &Attempt::cell);
    const Attempt attempt = *found;
    attempts_.erase(found);
    return attempt;
  }

  void answer_without_shard(const BakeOrder& order, CellOutcome outcome, std::string why) {
    BakeAnswer answer;
    answer.attempt = order.attempt;
    answer.report.id = order.job.id;
    answer.report.outcome = outcome;
    answer.report.error = std::move(why);
    send(BakeMessageKind::baked, to_bytes(answer));
  }

  void answer() {
    done_.silence();  // before polling, so that later results wake the thread again
    if (setup_ && !is_device_taken_ && device_start_.is_chosen()) take_device();
    while (scanner_) {
      const auto scan = scanner_->poll();
      if (!scan) break;
      send(BakeMessageKind::scanned, to_bytes(*scan));
    }
    while (stored_pipeline_) {
      auto job = stored_pipeline_->take_unstored();
      if (!job) break;
      bake_from_source(std::move(*job));
    }
    if (stored_pipeline_) answer_cells_of(*stored_pipeline_);
    if (pipeline_) answer_cells_of(*pipeline_);
  }

  void answer_cells_of(CellPipeline& pipeline) {
    while (auto report = pipeline.poll()) {
      const Attempt attempt = take_attempt(report->id);
      BakeAnswer answer{std::move(*report), attempt.number, work_.next()};
      if (attempt.returns_child && answer.report.outcome == CellOutcome::baked)
        if (const auto child = pipeline.find_child(answer.report.cell.file)) answer.child = to_bytes(*child);
      send(BakeMessageKind::baked, to_bytes(answer));
    }
  }

  const int fd_;
  const Wakeup done_;
  FrameReader inbox_;
  bool hung_up_ = false;
  std::optional<WorkerSetup> setup_;
  std::vector<std::uint8_t> source_bytes_;  ///< received parts of the sources; empty after the setup
  SceneSources sources_;
  std::optional<CellFingerprints> fingerprints_;  ///< fingerprints for the parameters and sources of this process
  /// The error that answers every request that needs the scene or the device; empty if there is none.
  std::string why_not_;
  DeviceStart device_start_{[this] { done_.ring(); }};
  bool is_device_taken_ = false;
  std::unique_ptr<ScanThread> scanner_;
  bool scans_ = false;  ///< true if scan requests are accepted
  /// Makes cells from stored shards without the device, until a cell must be baked from its source; null unless
  /// DeviceRequest::only_if_needed.
  std::unique_ptr<CellPipeline> stored_pipeline_;
  std::unique_ptr<CellPipeline> pipeline_;
  RunWorkMeter work_;
  std::vector<Attempt> attempts_;  ///< attempts at the cells in the pipeline, oldest first
};

}  // namespace

int serve_bakes(int fd) {
  record_trace();
  // The server is never destroyed: the destructor would wait for the cells in flight, whose results are not needed.
  static BakeServer server(fd);
  return server.run();
}

}  // namespace gigabake
