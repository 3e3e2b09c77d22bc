/// Progress display of a command's steps on standard error.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "app/messages/step_text.h"
#include "core/base/progress.h"

namespace gigabake::app {

/// Callbacks that detect and enforce a stop request.
struct StopCallbacks {
  std::function<bool()> is_there;  ///< called by every thread that advances a step
  /// Ends the process if a step has not stopped within half a second. If this callback is empty, the step may finish,
  /// and a line states that the next Ctrl-C ends the process at once.
  std::function<void()> end_process;
};

/// A display whose own thread prints the lines, so that a step without progress is shown too.
class StepDisplay : private ProgressListener {
 public:
  /// Prints the steps to `stream`; null prints nothing.
  StepDisplay(std::FILE* stream, StopCallbacks stop);
  /// Ends the current step, like end_step().
  ~StepDisplay() override;
  StepDisplay(const StepDisplay&) = delete;
  StepDisplay& operator=(const StepDisplay&) = delete;

  Progress progress() { return Progress(*this); }
  /// Stops printing the step, and clears its line on a terminal.
  void end_step();

 private:
  void step(const std::string& name, std::uint64_t total, const std::string& unit) override;
  void advance(std::uint64_t parts) override;
  void display_loop();
  void show_line(const std::string& line);
  void enforce_stop(double now_s);
  void clear_line();

  std::FILE* stream_;
  const bool is_terminal_;
  const StopCallbacks stop_;
  std::atomic<std::uint64_t> done_{0};
  std::mutex mutex_;  ///< guards the members below
  StepText text_;
  std::string shown_;  ///< text of the terminal's last line
  double stop_seen_s_ = -1;
  bool is_over_ = false, has_pressed_ = false, is_running_ = false;
  std::condition_variable over_;
  std::thread display_thread_;
};

}  // namespace gigabake::app
