#include "cluster/dispatch.h"

#include <chrono>
#include <thread>

#include "cluster/tags.h"
#include "scheduler/cell_queue.h"

namespace gigabake {
namespace {

/// One cell in each of the pipeline's three stages.
constexpr std::size_t jobs_per_rank = 3;

void rest() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

/// A pipeline, or the reason why this rank has none, which every job given to it then fails with.
class OwnPipeline {
 public:
  explicit OwnPipeline(const MakePipeline& make_pipeline) {
    try {
      pipeline_ = make_pipeline();
    } catch (const std::exception& e) {
      why_not_ = e.what();
    }
  }
  void submit(CellJob job) {
    if (pipeline_) return pipeline_->submit(std::move(job));
    CellReport report;
    report.id = job.id;
    report.error = why_not_;
    failed_.push_back(std::move(report));
  }
  std::optional<CellReport> poll() {
    if (pipeline_) return pipeline_->poll();
    if (failed_.empty()) return std::nullopt;
    CellReport report = std::move(failed_.back());
    failed_.pop_back();
    return report;
  }

 private:
  std::unique_ptr<CellPipeline> pipeline_;
  std::string why_not_;
  std::vector<CellReport> failed_;
};

class Master {
 public:
  Master(MpiSession& mpi, const std::vector<CellJob>& jobs, const MakePipeline& make_pipeline,
         const std::function<bool(const CellReport&)>& on_report)
      : mpi_(mpi),
        jobs_(jobs),
        on_report_(on_report),
        queue_(jobs),
        own_(make_pipeline),
        last_(std::size_t(mpi.ranks())) {}

  std::vector<CellReport> run() {
    try {
      for (std::size_t round = 0; round < jobs_per_rank; ++round)
        for (int rank = mpi_.ranks(); rank-- > 0;) give(rank);
      while (out_ > 0) collect();
    } catch (...) {
      stop_all();  // nobody may wait for a master that has given up
      throw;
    }
    stop_all();
    return std::move(reports_);
  }

 private:
  void collect() {
    bool idle = true;
    while (auto report = own_.poll()) take(0, std::move(*report)), idle = false;
    while (auto message = mpi_.poll()) take(message->from, report_from_bytes(message->bytes)), idle = false;
    if (idle) rest();
  }

  void stop_all() {
    for (int rank = 1; rank < mpi_.ranks(); ++rank) mpi_.send(rank, tag_stop, {});
  }

  void give(int rank) {
    if (stopped_) return;
    const auto job = queue_.next(last_[std::size_t(rank)]);
    if (!job) return;
    last_[std::size_t(rank)] = job;
    ++out_;
    if (rank == 0)
      own_.submit(jobs_[*job]);
    else
      mpi_.send(rank, tag_job, to_bytes(jobs_[*job]));
  }

  void take(int rank, CellReport report) {
    --out_;
    if (!on_report_(report)) stopped_ = true;
    reports_.push_back(std::move(report));
    give(rank);
  }

  MpiSession& mpi_;
  const std::vector<CellJob>& jobs_;
  const std::function<bool(const CellReport&)>& on_report_;
  CellQueue queue_;
  OwnPipeline own_;
  std::vector<std::optional<std::uint32_t>> last_;
  std::vector<CellReport> reports_;
  std::size_t out_ = 0;
  bool stopped_ = false;
};

}  // namespace

std::vector<CellReport> dispatch(MpiSession& mpi, const std::vector<CellJob>& jobs, const MakePipeline& make_pipeline,
                                 const std::function<bool(const CellReport&)>& on_report) {
  return Master(mpi, jobs, make_pipeline, on_report).run();
}

void work(MpiSession& mpi, const MakePipeline& make_pipeline) {
  OwnPipeline own(make_pipeline);
  for (bool stop = false; !stop;) {
    bool idle = true;
    while (auto message = mpi.poll()) {
      idle = false;
      if (message->tag == tag_stop) stop = true;
      if (message->tag == tag_job) own.submit(job_from_bytes(message->bytes));
    }
    while (auto report = own.poll()) mpi.send(0, tag_report, to_bytes(*report)), idle = false;
    if (idle) rest();
  }
}

}  // namespace gigabake
