#include "cluster/bake/status_feed.h"

#include <chrono>
#include <cmath>
#include <unistd.h>
#include <utility>

#include "cluster/mpi/collective.h"
#include "core/base/error.h"
#include "format/system/message.h"
#include "format/system/publish.h"

namespace gigabake {
namespace {

constexpr double update_every_s = 0.1, write_every_s = 1;

/// Returns true after the interval, and also if the clock was set back.
bool is_due(double now_s, double last_s, double every_s) { return std::fabs(now_s - last_s) >= every_s; }

}  // namespace

double unix_now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

StatusFeed::StatusFeed(std::filesystem::path out, int ranks, std::filesystem::path metrics, BakeListener listener)
    : out_(std::move(out)),
      metrics_(std::move(metrics)),
      listener_(std::move(listener)),
      record_({std::filesystem::absolute(out_).string(), host_name(), ::getpid(), ranks}, unix_now_s()) {}

void StatusFeed::take(const BakeEvent& event) {
  record_.add(event, unix_now_s());
  const auto* entered = std::get_if<StateEntered>(&event);
  if (std::holds_alternative<BakeAlive>(event)) update();
  if (std::holds_alternative<DispatchBegan>(event)) publish();
  if (entered != nullptr && entered->state != BakeState::draining) publish();
}

void StatusFeed::update() {
  began_ = true;
  const double now_s = unix_now_s();
  if (!is_due(now_s, updated_s_, update_every_s)) return;
  updated_s_ = now_s;
  const BakeStatus status = record_.at(now_s);
  if (listener_) listener_(StatusUpdated{status});
  if (!is_due(now_s, written_s_, write_every_s)) return;
  written_s_ = now_s;
  write(status);
}

void StatusFeed::publish() {
  began_ = true;
  updated_s_ = written_s_ = unix_now_s();
  const BakeStatus status = record_.at(updated_s_);
  if (listener_) listener_(StatusUpdated{status});
  write(status);
}

void StatusFeed::stop() {
  record_.enter(BakeState::drained);
  if (began_) publish();
}

void StatusFeed::fail(const std::string& reason) {
  record_.fail(reason);
  if (began_) publish();
}

void StatusFeed::write(const BakeStatus& status) {
  try {
    write_status(out_, status);
    if (!metrics_.empty()) publish_file(metrics_, to_prometheus(status), Durability::while_up, Leftovers::remove);
  } catch (const InputError& e) {
    if (!warned_) print_message("the bake continues without its status: {}\n", e.what());
    warned_ = true;
  }
}

}  // namespace gigabake
