#include "cluster/process/bake_process.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fmt/format.h>
#include <poll.h>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr std::chrono::seconds max_kill_wait{10}, first_pause{1}, max_pause{60};
/// Bytes of the sources per message: the process holds one message twice while it assembles the sources.
constexpr std::size_t part_bytes = std::size_t(1) << 24;
constexpr int deaths_without_pause = 2;
constexpr int doublings = 6;  // the pause doubles at most this many times, up to max_pause

HangWatch::Clock::duration seconds(double s) {
  return std::chrono::duration_cast<HangWatch::Clock::duration>(std::chrono::duration<double>(s));
}

/// Returns true if the same start may succeed later because the error is a temporary shortage.
bool is_temporary(const std::error_code& code) {
  for (const std::errc shortage :
       {std::errc::resource_unavailable_try_again, std::errc::not_enough_memory, std::errc::too_many_files_open,
        std::errc::too_many_files_open_in_system, std::errc::text_file_busy, std::errc::interrupted})
    if (code == shortage) return true;
  return false;
}

/// Returns a hint for a start that failed.
std::string advice(const std::filesystem::path& program) {
  return program.string().starts_with("/proc/") ? "; a bake needs /proc to be mounted" : "";
}

std::unique_ptr<ChildProcess> started_child(const BakeProcessOptions& options) {
  return std::make_unique<ChildProcess>(options.program, std::vector<std::string>{"bake-process"});
}

}  // namespace

BakeProcess::BakeProcess(const WorkerSetup& setup, BakeProcessOptions options, std::unique_ptr<ChildProcess> early)
    : setup_(to_bytes(setup)),
      sources_(setup.sources),
      options_(std::move(options)),
      early_(std::move(early)),
      watch_(seconds(options_.timeouts.no_progress_s)) {}

void BakeProcess::prepare() {
  if (!child_ && !is_paused()) start();
}

void BakeProcess::submit(BakeOrder order) {
  expect_work();
  if (cells_.empty()) cell_since_ = watch_.watched();
  cells_.push_back(std::move(order));
  if (channel_) channel_->send(BakeMessageKind::bake, to_bytes(cells_.back()));
  if (!child_) work();
}

void BakeProcess::scan(std::uint32_t tile) {
  expect_work();
  if (tiles_.empty()) tile_since_ = watch_.watched();
  tiles_.push_back(tile);
  if (channel_) channel_->send(BakeMessageKind::scan, scan_request(tile));
  if (!child_) work();
}

void BakeProcess::expect_work() {
  if (in_flight() == 0) watch_.start(Clock::now());
}

std::optional<BakeProcess::Event> BakeProcess::poll() {
  if (events_.empty()) work();
  if (events_.empty()) return std::nullopt;
  Event event = std::move(events_.front());
  events_.pop_front();
  return event;
}

void BakeProcess::work() {
  if (!child_ && in_flight() != 0 && !is_paused()) start();
  if (channel_) exchange();
  if (channel_ && must_watch()) check_for_hang();
  if (child_ && !channel_) report_end();
}

void BakeProcess::start() {
  std::erase_if(abandoned_, [](const auto& child) { return child->ended().has_value(); });
  has_started_ = false;
  try {
    child_ = early_ ? std::move(early_) : started_child(options_);
  } catch (const std::system_error& e) {
    if (!is_temporary(e.code())) throw std::runtime_error(fmt::format("{}{}", e.what(), advice(options_.program)));
    return report_death(reason_of(e));
  }
  channel_.emplace(child_->socket());
  send_setup();
  for (const std::uint32_t tile : tiles_) channel_->send(BakeMessageKind::scan, scan_request(tile));
  for (const BakeOrder& order : cells_) channel_->send(BakeMessageKind::bake, to_bytes(order));
  watch_.start(Clock::now());
  cell_since_ = tile_since_ = watch_.watched();
}

void BakeProcess::send_setup() {
  const std::span<const std::uint8_t> sources = *sources_;
  for (std::size_t at = 0; at < sources.size(); at += part_bytes)
    channel_->send(BakeMessageKind::sources, sources.subspan(at, std::min(part_bytes, sources.size() - at)));
  channel_->send(BakeMessageKind::setup, setup_);
}

void BakeProcess::exchange() {
  try {
    channel_->flush();
    while (const auto message = channel_->receive()) take(*message);
    if (channel_->hung_up()) end({});
  } catch (const InputError& e) {
    end(fmt::format("sent an invalid message: {}", e.what()));
  } catch (const std::system_error& e) {
    end(e.what());
  }
}

void BakeProcess::take(const BakeMessage& message) {
  if (message.kind == BakeMessageKind::started) {
    has_started_ = true;
    return;
  }
  if (message.kind == BakeMessageKind::ready) {
    device_ = device_from_bytes(message.payload);
    return;
  }
  if (message.kind == BakeMessageKind::scanned) {
    TileScan scan = scan_from_bytes(message.payload);
    const auto asked = std::ranges::find(tiles_, scan.tile);
    if (asked == tiles_.end()) throw InputError("scan", "tile", "was not requested");
    if (asked == tiles_.begin()) tile_since_ = watch_.watched();
    tiles_.erase(asked);
    events_.push_back(Scanned{std::move(scan)});
  } else if (message.kind == BakeMessageKind::baked) {
    BakeAnswer answer = answer_from_bytes(message.payload);
    const auto asked = std::ranges::find_if(cells_, [&](const BakeOrder& order) {
      return order.job.id == answer.report.id && order.attempt == answer.attempt;
    });
    if (asked == cells_.end()) throw InputError("cell report", "id", "was not requested");
    if (asked == cells_.begin()) cell_since_ = watch_.watched();
    cells_.erase(asked);
    events_.push_back(Baked{std::move(answer.report), answer.attempt, answer.work, std::move(answer.child)});
  } else {
    throw InputError("bake message", "kind", "expected an answer");
  }
  deaths_in_a_row_ = 0;
}

void BakeProcess::check_for_hang() {
  const auto now = Clock::now();
  if (now < watch_.next_look()) return;
  watch_.look(now, child_->activity(), channel_->bytes_moved());
  if (watch_.is_stalled())
    return end(fmt::format("hung: no CPU time for {:g} s in {}", options_.timeouts.no_progress_s, oldest()));
  const Clock::duration limit = seconds(options_.timeouts.cell_timeout_s);
  if (!cells_.empty() && watch_.watched() - cell_since_ >= limit)
    return end(
        fmt::format("not done after {:g} s: cell {}", options_.timeouts.cell_timeout_s, cells_.front().job.name));
  if (!tiles_.empty() && watch_.watched() - tile_since_ >= limit)
    end(fmt::format("not done after {:g} s: scan of tile {}", options_.timeouts.cell_timeout_s, tiles_.front()));
}

std::string BakeProcess::oldest() const {
  if (!cells_.empty()) return "cell " + cells_.front().job.name;
  return tiles_.empty() ? "its start" : fmt::format("the scan of tile {}", tiles_.front());
}

/// Ends the process. `why` is nullopt if the process ended by itself.
void BakeProcess::end(std::optional<std::string> why) {
  kill_reason_ = std::move(why);
  channel_.reset();
  child_->kill();  // a process that closed its socket is already ending; its exit status is kept if it ends first
  ending_since_ = Clock::now();
}

/// Waits for the end of a killed process, so that two bake processes never overlap: a device's memory may be too small
/// for two. A process that cannot be killed is abandoned after max_kill_wait.
void BakeProcess::report_end() {
  std::optional<std::string> how = child_->ended();
  if (!how && Clock::now() - ending_since_ < max_kill_wait) return;
  if (how && how->find("SIGKILL") != std::string::npos) *how += ": perhaps the system ran out of memory";
  peak_bytes_ = std::max(peak_bytes_, child_->peak_bytes());
  if (!how) abandoned_.push_back(std::move(child_));
  child_.reset();
  report_death(kill_reason_ ? *kill_reason_ : how.value_or("closed its connection, and cannot be killed"));
}

void BakeProcess::report_death(std::string why) {
  Died died{std::move(why), {cells_.begin(), cells_.end()}, {tiles_.begin(), tiles_.end()}, has_started_};
  cells_.clear();
  tiles_.clear();
  events_.push_back(std::move(died));
  const int pauses = ++deaths_in_a_row_ - deaths_without_pause;
  if (pauses > 0)
    not_before_ =
        Clock::now() + std::min<Clock::duration>(first_pause * (1 << std::min(pauses - 1, doublings)), max_pause);
}

void BakeProcess::wait(std::chrono::milliseconds maximum) const {
  if (!events_.empty()) return;
  Clock::time_point until = Clock::now() + maximum;
  if (child_ && !channel_) until = std::min(until, Clock::now() + std::chrono::milliseconds(1));
  if (channel_ && must_watch()) until = std::min(until, watch_.next_look());
  if (!child_ && in_flight() != 0) until = std::min(until, not_before_);
  const auto rest = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
  pollfd socket{channel_ ? child_->socket() : -1, POLLIN, 0};
  if (channel_ && channel_->has_unsent()) socket.events |= POLLOUT;
  if (::poll(&socket, 1, int(std::max(rest, std::chrono::milliseconds(0)).count())) < 0 && errno != EINTR)
    throw std::system_error(errno, std::generic_category(), "poll");
}

std::optional<pid_t> BakeProcess::pid() const { return channel_ ? std::optional(child_->pid()) : std::nullopt; }

std::unique_ptr<ChildProcess> start_early(const DeviceRequest& expected, const BakeProcessOptions& options) {
  try {
    auto child = started_child(options);
    FrameChannel(child->socket()).send(BakeMessageKind::device, to_bytes(expected));  // fits into the socket's buffer
    return child;
  } catch (const std::system_error&) {
    return nullptr;  // BakeProcess starts a process later, and reports why it cannot
  }
}

std::string no_start_error(const std::string& why) { return "the bake process ended during its start: " + why; }

void throw_no_start(const std::string& why) { throw std::runtime_error(no_start_error(why)); }

std::uint64_t BakeProcess::peak_bytes() const { return std::max(peak_bytes_, child_ ? child_->peak_bytes() : 0); }

}  // namespace gigabake
