/// Times in which the stages of a bake are busy, to find the stage that bounds a run. Stages of different cells
/// overlap, so the sum of a stage's times does not show whether another stage waits for it. The time in which only this
/// stage is busy does.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>

#include "core/base/rules.h"

namespace gigabake {

enum class BakeStage : std::uint8_t { reading, kernels, packing, writing };
template <>
constexpr auto names_of<BakeStage>() {
  return std::to_array<std::string_view>({"reading", "kernels", "packing", "writing"});
}

/// A partition of the seconds from the first stage of a process to a later time.
struct StageTimes {
  static constexpr std::size_t stages = names_of<BakeStage>().size();
  std::array<double, stages> exclusive_s{};  ///< only this stage was busy
  double several_s = 0;                      ///< two or more stages were busy
  double idle_s = 0;                         ///< no stage was busy

  double all_s() const;
  StageTimes& operator+=(const StageTimes& other);
  StageTimes since(const StageTimes& earlier) const;
  /// Returns the stage with the max of exclusive_s; nullopt if all are 0.
  std::optional<BakeStage> bound() const;
};

/// A clock of the stages' states. Several threads may be in the same stage. Thread-safe.
class StageClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// Range   Times are ascending, except that an earlier time counts as the latest time so far.
  void enter(BakeStage stage, Clock::time_point now = Clock::now());
  void leave(BakeStage stage, Clock::time_point now = Clock::now());
  StageTimes times(Clock::time_point now = Clock::now()) const;

 private:
  void advance(Clock::time_point now);

  mutable std::mutex mutex_;
  std::array<int, StageTimes::stages> threads_{};  ///< number of threads in each stage
  std::optional<Clock::time_point> latest_;        ///< nullopt: no stage has begun
  StageTimes times_;
};

/// Returns the clock of this process, which pipelines and shard writers use.
StageClock& process_stage_clock();

/// The stay of a thread in a stage of process_stage_clock().
class InStage {
 public:
  explicit InStage(BakeStage stage) : stage_(stage) { process_stage_clock().enter(stage); }
  ~InStage() { process_stage_clock().leave(stage_); }
  InStage(const InStage&) = delete;
  InStage& operator=(const InStage&) = delete;

 private:
  const BakeStage stage_;
};

}  // namespace gigabake
