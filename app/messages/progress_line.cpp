#include "app/messages/progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include "app/messages/status_text.h"
#include "format/system/message.h"

namespace gigabake::app {
namespace {

constexpr int bar_width = 30;
constexpr double bar_every_s = 0.1;

}  // namespace

ProgressLine::ProgressLine(std::FILE* stream, double line_every_s)
    : stream_(stream), terminal_(::isatty(::fileno(stream)) == 1), last_(Clock::now()) {
  const std::chrono::duration<double> every(terminal_ ? bar_every_s : line_every_s);
  every_ = std::chrono::duration_cast<Clock::duration>(every);
}

ProgressLine::~ProgressLine() { leave_bar(); }

void ProgressLine::show(const BakeStatus& status) {
  const Phase phase = status.state == BakeState::scanning ? Phase::scan : Phase::cells;
  if (ended_ == phase) return;
  const double share = share_done(status);
  const auto now = Clock::now();
  if (share < 1 && now - last_ < every_) return;
  last_ = now;
  if (terminal_) {
    const int filled = int(bar_width * share);
    write_part(stream_,
               fmt::format("\r\033[K[{:=<{}}{: <{}}] {}", "", filled, "", bar_width - filled, one_line(status)));
    bar_is_shown_ = true;
  } else {
    write_line(one_line(status));
  }
  if (share >= 1) {
    leave_bar();
    ended_ = phase;
  }
  std::fflush(stream_);
}

void ProgressLine::say(const std::string& line) {
  if (bar_is_shown_) write_part(stream_, "\r\033[K");
  write_line(line);
  bar_is_shown_ = false;
}

void ProgressLine::write_line(const std::string& line) {
  if (stream_ == stderr) return print_message("{}\n", line);
  write_part(stream_, line + "\n");
}

void ProgressLine::leave_bar() {
  if (bar_is_shown_) write_part(stream_, "\n");
  bar_is_shown_ = false;
}

}  // namespace gigabake::app
