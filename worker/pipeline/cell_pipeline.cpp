#include "worker/pipeline/cell_pipeline.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/trace.h"
#include "format/system/meters/stage_clock.h"
#include "worker/pipeline/bounded_queue.h"
#include "worker/pipeline/cell_stages.h"
#include "worker/pipeline/writer_pool_size.h"

namespace gigabake {
namespace {

/// Max number of queued overviews before the reader blocks. The queue is used only with a device.
constexpr std::size_t overviews_waiting = 64;

/// Number of threads that flush shards to disk. More threads flush no more shards per second on an SSD.
constexpr int publishers = 4;

/// Runs one stage on a cell; an exception makes the report final. `of_input` is the outcome of an InputError in this
/// stage. The write stage passes `failed`, because its errors are I/O errors. `stage` is the stage on the process's
/// clock; the write stage passes nullopt, because the writer of shards distinguishes packing from writing. `seconds` is
/// null for a stage that mostly waits for the disk. `step` is the name in a trace.
template <class Work>
void run_stage(InFlightCell& cell, const char* step, double CellReport::*seconds, std::optional<BakeStage> stage,
               CellOutcome of_input, const Work& work) {
  if (cell.is_final) return;
  const auto start = std::chrono::steady_clock::now();
  const auto fail = [&](std::string line, CellOutcome outcome = CellOutcome::failed) {
    cell.report.outcome = outcome;
    cell.report.error = std::move(line);
    cell.is_final = true;
    cell.loaded.reset();
    cell.device_input.reset();
    cell.device_volume.reset();
    cell.volume_count.reset();
    cell.packed.reset();
    cell.volume = {};
    cell.publication.reset();
  };
  try {
    const TraceSpan span(step, cell.job.name);
    std::optional<InStage> in_stage;
    if (stage) in_stage.emplace(*stage);
    work(cell);
  } catch (const std::bad_alloc&) {
    fail("not enough memory for this cell; use a smaller `cell_voxels` or fewer ranks on the machine");
  } catch (const IoError& e) {
    fail(e.what());
  } catch (const InputError& e) {
    fail(e.what(), of_input);
  } catch (const std::exception& e) {
    fail(e.what());
  }
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (seconds != nullptr) cell.report.*seconds += taken;
}

}  // namespace

class CellPipeline::Stages {
 public:
  Stages(SceneSources sources, BakeParameters parameters, const WorkerOptions& options, std::function<void()> on_report)
      : stages_(std::move(sources), parameters, options),
        has_device_(options.cuda_device.has_value()),
        on_report_(std::move(on_report)),
        loaded_(readahead_cells_for(options)) {
    preparer_ = std::thread([this] { stages_.prepare(); });
    producers_of_loaded_ = readers_for(options);
    for (std::size_t r = producers_of_loaded_; r > 0; --r) readers_.emplace_back([this] { read_all(); });
    const std::size_t computers = concurrent_cells_for(options);
    producers_ = has_device_ ? readback_workers + overview_makers_for(options) : computers;
    for (std::size_t c = 0; c < computers; ++c) computers_.emplace_back([this] { compute_all(); });
    if (has_device_) {
      for (std::size_t b = 0; b < readback_workers; ++b)
        readback_threads_.emplace_back([this, b] { read_back_all(b); });
      for (std::size_t m = overview_makers_for(options); m > 0; --m)
        overview_makers_.emplace_back([this] { make_overviews(); });
    }
    const int writers = writer_pool_size_for(options).writers;
    producers_of_written_ = std::size_t(writers);
    for (int w = writers; w > 0; --w) writers_.emplace_back([this] { write_all(); });
    for (int p = 0; p < publishers; ++p) publishers_.emplace_back([this] { publish_all(); });
  }

  ~Stages() {
    {
      const std::scoped_lock lock(mutex_);
      stopping_ = true;
    }
    submitted_.notify_all();
    preparer_.join();
    for (std::thread& reader : readers_) reader.join();
    for (std::thread& computer : computers_) computer.join();
    for (std::thread& readback_worker : readback_threads_) readback_worker.join();
    for (std::thread& maker : overview_makers_) maker.join();
    for (std::thread& writer : writers_) writer.join();
    for (std::thread& publisher : publishers_) publisher.join();
  }

  void submit(CellJob job) {
    {
      const std::scoped_lock lock(mutex_);
      jobs_.push_back(std::move(job));
      ++in_flight_;
    }
    submitted_.notify_all();
  }

  std::optional<CellReport> poll() {
    const std::scoped_lock lock(mutex_);
    if (reports_.empty()) return std::nullopt;
    CellReport report = std::move(reports_.front());
    reports_.pop_front();
    --in_flight_;
    return report;
  }

  std::optional<CellJob> take_unstored() {
    const std::scoped_lock lock(mutex_);
    if (unstored_.empty()) return std::nullopt;
    CellJob job = std::move(unstored_.front());
    unstored_.pop_front();
    --in_flight_;
    return job;
  }

  OverviewInputs& overview_inputs() { return stages_.overview_inputs(); }

  std::size_t in_flight() const {
    const std::scoped_lock lock(mutex_);
    return in_flight_;
  }

 private:
  std::optional<CellJob> next_job() {
    std::unique_lock lock(mutex_);
    submitted_.wait(lock, [this] { return stopping_ || !jobs_.empty(); });
    if (stopping_) return std::nullopt;
    CellJob job = std::move(jobs_.front());
    jobs_.pop_front();
    return job;
  }

  void read_all() {
    while (auto job = next_job()) {
      auto cell = std::make_unique<InFlightCell>(std::move(*job));
      if (has_device_ && is_overview(cell->job)) {
        overviews_.push(std::move(cell));
        continue;
      }
      read(*cell);
      if (cell->is_unstored)
        return_unstored(std::move(cell->job));
      else
        loaded_.push(std::move(cell));
    }
    if (--producers_of_loaded_ != 0) return;
    loaded_.close();
    overviews_.close();
  }

  void return_unstored(CellJob job) {
    {
      const std::scoped_lock lock(mutex_);
      unstored_.push_back(std::move(job));
    }
    if (on_report_) on_report_();
  }

  void read(InFlightCell& cell) {
    // A missing child may still appear, because another host may have written it a moment ago.
    const CellOutcome of_input = is_overview(cell.job) ? CellOutcome::failed : CellOutcome::refused;
    run_stage(cell, "read", &CellReport::read_s, BakeStage::reading, of_input,
              [this](InFlightCell& c) { stages_.read(c); });
  }

  /// Reads and computes overviews on the host while a device bakes cells, so that the device never waits for an
  /// overview.
  void make_overviews() {
    while (auto cell = overviews_.take()) {
      read(**cell);
      run_stage(**cell, "make overview", &CellReport::kernel_s, BakeStage::kernels, CellOutcome::refused,
                [this](InFlightCell& c) {
                  stages_.compute(c);
                  stages_.read_back(c, 0);
                });
      ready_.push(std::move(*cell));
    }
    release_producer();
  }

  /// Closes the writers' queue when the last thread that feeds it ends.
  void release_producer() {
    if (--producers_ == 0) ready_.close();
  }

  /// Runs the compute stage. Without a device there is no readback stage: the compute threads feed the writers, each
  /// with the cells that it computes.
  void compute_all() {
    BoundedQueue<std::unique_ptr<InFlightCell>>& next = has_device_ ? computed_ : ready_;
    while (auto cell = loaded_.take()) {
      stages_.wait_for_device_memory();
      run_stage(**cell, "compute", &CellReport::kernel_s, BakeStage::kernels, CellOutcome::refused,
                [this](InFlightCell& c) {
                  stages_.compute(c);
                  if (!has_device_) stages_.read_back(c, 0);
                });
      next.push(std::move(*cell));
    }
    if (has_device_)
      computed_.close();
    else
      release_producer();
  }

  void read_back_all(std::size_t readback_worker) {
    while (auto cell = computed_.take()) {
      run_stage(**cell, "read back", &CellReport::kernel_s, BakeStage::packing, CellOutcome::refused,
                [this, readback_worker](InFlightCell& c) { stages_.read_back(c, readback_worker); });
      ready_.push(std::move(*cell));
    }
    release_producer();
  }

  void write_all() {
    while (auto cell = ready_.take()) {
      run_stage(**cell, "write", &CellReport::write_s, {}, CellOutcome::failed,
                [this](InFlightCell& c) { stages_.write(c); });
      if ((*cell)->is_final)
        report(**cell);
      else
        written_.push(std::move(*cell));
    }
    if (--producers_of_written_ == 0) written_.close();
  }

  /// Flushes shards to disk on several threads. A flush waits for the disk, and flushes that wait together take about
  /// as long as one.
  void publish_all() {
    while (auto cell = written_.take()) {
      run_stage(**cell, "publish", nullptr, BakeStage::writing, CellOutcome::failed,
                [this](InFlightCell& c) { stages_.publish(c); });
      report(**cell);
    }
  }

  void report(InFlightCell& cell) {
    {
      const std::scoped_lock lock(mutex_);
      reports_.push_back(std::move(cell.report));
    }
    if (on_report_) on_report_();
  }

  CellStages stages_;
  const bool has_device_;
  const std::function<void()> on_report_;
  mutable std::mutex mutex_;
  std::condition_variable submitted_;
  std::deque<CellJob> jobs_, unstored_;
  std::deque<CellReport> reports_;
  std::size_t in_flight_ = 0;
  bool stopping_ = false;
  BoundedQueue<std::unique_ptr<InFlightCell>> loaded_;
  BoundedQueue<std::unique_ptr<InFlightCell>> computed_, ready_, written_;
  BoundedQueue<std::unique_ptr<InFlightCell>> overviews_{
      overviews_waiting};  ///< jobs only; their children are not yet read
  std::thread preparer_;
  std::atomic<std::size_t> producers_of_loaded_{0};  ///< number of threads that feed loaded_ and overviews_
  std::atomic<std::size_t> producers_{0};            ///< number of threads that feed ready_
  std::atomic<std::size_t> producers_of_written_{0};
  std::vector<std::thread> readers_, computers_, readback_threads_, overview_makers_;
  std::vector<std::thread> writers_, publishers_;
};

CellPipeline::CellPipeline(SceneSources sources, BakeParameters parameters, const WorkerOptions& options,
                           std::function<void()> on_report)
    : stages_(std::make_unique<Stages>(std::move(sources), parameters, options, std::move(on_report))) {}
CellPipeline::~CellPipeline() = default;

void CellPipeline::submit(CellJob job) { stages_->submit(std::move(job)); }
std::optional<CellReport> CellPipeline::poll() { return stages_->poll(); }
std::optional<CellJob> CellPipeline::take_unstored() { return stages_->take_unstored(); }
std::shared_ptr<const OverviewChild> CellPipeline::find_child(const std::string& file) {
  return stages_->overview_inputs().find(file);
}
void CellPipeline::keep_child(const std::string& file, OverviewChild child) {
  stages_->overview_inputs().keep(file, std::move(child));
}
std::size_t CellPipeline::in_flight() const { return stages_->in_flight(); }

}  // namespace gigabake
