#include "app/messages/step_display.h"

#include <chrono>
#include <unistd.h>
#include <utility>

#include "format/system/message.h"

namespace gigabake::app {
namespace {

constexpr std::chrono::milliseconds poll_interval{100};
/// A step that stops within this time prints no message.
constexpr double stop_grace_s = 0.5;

double steady_now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

StepDisplay::StepDisplay(std::FILE* stream, StopCallbacks stop)
    : stream_(stream),
      is_terminal_(stream != nullptr && ::isatty(::fileno(stream)) == 1),
      stop_(std::move(stop)),
      text_(steady_now_s(), is_terminal_),
      display_thread_([this] { display_loop(); }) {}

StepDisplay::~StepDisplay() {
  end_step();
  {
    const std::scoped_lock lock(mutex_);
    is_over_ = true;
  }
  over_.notify_all();
  display_thread_.join();
}

void StepDisplay::end_step() {
  const std::scoped_lock lock(mutex_);
  text_.end();
  is_running_ = false;
  clear_line();
}

void StepDisplay::step(const std::string& name, std::uint64_t total, const std::string& unit) {
  const std::scoped_lock lock(mutex_);
  done_ = 0;
  text_.begin(name, total, unit, steady_now_s());
  is_running_ = true;
}

void StepDisplay::advance(std::uint64_t parts) {
  done_.fetch_add(parts, std::memory_order_relaxed);
  if (stop_.is_there()) throw Stopped();
}

void StepDisplay::display_loop() {
  std::unique_lock lock(mutex_);
  while (!over_.wait_for(lock, poll_interval, [this] { return is_over_; })) {
    const double now_s = steady_now_s();
    const auto line = text_.line(done_, now_s);
    if (is_running_ && stop_.is_there())
      enforce_stop(now_s);
    else if (line)
      show_line(*line);
  }
}

void StepDisplay::show_line(const std::string& line) {
  if (stream_ == nullptr || line == shown_) return;
  if (is_terminal_) {
    write_part(stream_, "\r\033[K" + line);
    shown_ = line;
  } else {
    print_message("{}\n", line);
  }
  std::fflush(stream_);
}

void StepDisplay::enforce_stop(double now_s) {
  if (stop_seen_s_ < 0) stop_seen_s_ = now_s;
  if (has_pressed_ || now_s - stop_seen_s_ < stop_grace_s) return;
  has_pressed_ = true;
  if (stop_.end_process) {
    clear_line();
    stop_.end_process();
  }
  show_line("stopping; press Ctrl-C again to stop immediately");
}

void StepDisplay::clear_line() {
  if (shown_.empty()) return;
  write_part(stream_, "\r\033[K");
  std::fflush(stream_);
  shown_.clear();
}

}  // namespace gigabake::app
