/// A command's steps as standard error shows them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "app/messages/step_text.h"
#include "lattice/progress.h"

namespace gigabake::app {

/// How steps are stopped.
struct StopWish {
  std::function<bool()> is_there;  ///< called by every thread that advances a step
  /// Called where a step goes on for half a second all the same; none: it is waited for, and a line says that the next
  /// Ctrl-C does not wait.
  std::function<void()> end_process;
};

/// A thread of its own shows the lines, so that a step that is long silent is seen too.
class StepDisplay : private ProgressListener {
 public:
  /// stream: null says nothing.
  StepDisplay(std::FILE* stream, StopWish stop);
  /// As end_step().
  ~StepDisplay() override;
  StepDisplay(const StepDisplay&) = delete;
  StepDisplay& operator=(const StepDisplay&) = delete;

  Progress progress() { return Progress(*this); }
  /// Nothing more is said of the step; its line is gone from a terminal.
  void end_step();

 private:
  void step(const std::string& name, std::uint64_t total, const std::string& unit) override;
  void advance(std::uint64_t parts) override;
  void show_until_the_end();
  void show_line(const std::string& line);
  void press_stop(double now_s);
  void clear_line();

  std::FILE* stream_;
  const bool is_terminal_;
  const StopWish stop_;
  std::atomic<std::uint64_t> done_{0};
  std::mutex mutex_;  ///< of what follows
  StepText text_;
  std::string shown_;  ///< on a terminal's last line
  double stop_seen_s_ = -1;
  bool is_over_ = false, has_pressed_ = false, is_running_ = false;
  std::condition_variable over_;
  std::thread shower_;
};

}  // namespace gigabake::app
