#include "app/messages/step_text.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "app/messages/status_text.h"
#include "core/base/pluralize.h"

namespace gigabake::app {
namespace {

constexpr double silent_s = 2, log_line_every_s = 10, rewritten_every_s = 0.1;

}  // namespace

StepText::StepText(double now_s, bool is_terminal) : is_terminal_(is_terminal), next_s_(now_s + silent_s) {}

void StepText::begin(std::string name, std::uint64_t total, std::string unit, double now_s) {
  name_ = std::move(name);
  unit_ = std::move(unit);
  total_ = total;
  seen_ = 0;
  began_s_ = now_s;
  time_left_ = TimeLeft();
  time_left_.begins(0, now_s);
  is_running_ = true;
}

void StepText::end() { is_running_ = false; }

std::optional<std::string> StepText::line(std::uint64_t done, double now_s) {
  if (!is_running_) return std::nullopt;
  if (done > seen_) time_left_.ends(0, double(done - seen_), now_s);
  seen_ = std::max(seen_, done);
  if (now_s < next_s_) return std::nullopt;
  next_s_ = now_s + (is_terminal_ ? rewritten_every_s : log_line_every_s);
  return text(seen_, now_s);
}

std::string StepText::text(std::uint64_t done, double now_s) const {
  if (total_ == 0)
    return fmt::format("{}: {}{}", name_, done != 0 ? pluralize(done, unit_) + ", " : std::string(),
                       readable_seconds(now_s - began_s_));
  const double share = std::min(1.0, double(done) / double(total_));
  std::string line = unit_.empty()
                         ? fmt::format("{}: {:.0f} %", name_, 100 * share)
                         : fmt::format("{}: {} of {}", name_, std::min(done, total_), pluralize(total_, unit_));
  if (const auto left = time_left_.left_s(double(total_) * (1 - share), now_s))
    line += fmt::format(", {} left", readable_seconds(*left));
  return line;
}

}  // namespace gigabake::app
