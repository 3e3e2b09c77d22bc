#include "scripted_ranks.h"

#include <algorithm>
#include <string>

#include "core/io/bytes.h"
#include "worker/pipeline/bake_messages.h"

namespace gigabake {
namespace {

constexpr double turn_s = 0.05, sign_s = 2;

}  // namespace

void ScriptedRanks::kill_process(int rank) {
  Rank& r = ranks_[std::size_t(rank)];
  r.hand.clear();
  ++r.deaths;
  const std::string why = "killed by signal 9 (SIGKILL)";
  say(rank, tag_died, {why.begin(), why.end()});
}

void ScriptedRanks::send(int rank, Tag tag, std::vector<std::uint8_t> bytes) {
  Rank& r = ranks_[std::size_t(rank)];
  if (tag == tag_stop) r.stopped = true;
  r.inbox.emplace_back(tag, std::move(bytes));
}

/// Handles a message by an independent implementation of the protocol of cluster/mpi/message.h.
void ScriptedRanks::handle(Rank& rank, Tag tag, const std::vector<std::uint8_t>& bytes) {
  rank.max_silence_s = std::max(rank.max_silence_s, now_s_ - rank.heard_s);
  rank.heard_s = now_s_;
  if (tag != tag_job) return;
  std::uint32_t known_deaths = 0;
  ByteReader(bytes, "order").get(known_deaths);
  if (known_deaths != rank.deaths) return;
  const BakeOrder order = order_from_bytes(std::span(bytes).subspan(sizeof known_deaths));
  ++orders_;
  const double from_s = rank.hand.empty() ? now_s_ : std::max(now_s_, rank.hand.back().done_s);
  const double takes_s = std::uniform_real_distribution(0.01, 0.6)(random_);
  rank.hand.push_back({order.job.id, order.attempt, from_s + takes_s});
}

void ScriptedRanks::answer(int rank, const Work& work) {
  const Fate end = fate(rank, work.job);
  if (end == Fate::kills_the_process) return kill_process(rank);
  BakeAnswer answer;
  answer.attempt = work.attempt;
  answer.report.id = work.job;
  answer.report.outcome = end == Fate::baked    ? CellOutcome::empty
                          : end == Fate::failed ? CellOutcome::failed
                                                : CellOutcome::refused;
  if (end != Fate::baked) answer.report.error = "as scripted";
  std::vector<std::uint8_t> bytes = to_bytes(answer);
  const Delivery way = delivery(rank, work.job);
  if (way == Delivery::malformed) bytes.resize(random_() % bytes.size());
  if (way == Delivery::twice) say(rank, tag_report, bytes);
  say(rank, tag_report, std::move(bytes));
}

void ScriptedRanks::work(int rank) {
  Rank& r = ranks_[std::size_t(rank)];
  if (r.stalled) return;
  for (; !r.inbox.empty(); r.inbox.pop_front()) handle(r, r.inbox.front().first, r.inbox.front().second);
  while (!r.hand.empty() && r.hand.front().done_s <= now_s_) {
    const Work done = r.hand.front();
    r.hand.pop_front();
    answer(rank, done);
  }
  if (rank == 0 || now_s_ - r.shown_s < sign_s) return;
  r.shown_s = now_s_;
  ByteWriter sign;
  sign.put(std::uint64_t(rank) << 20);
  sign.put("host" + std::to_string(rank));
  say(rank, tag_alive, sign.take());
}

std::optional<Message> ScriptedRanks::receive() {
  if (under_way_.empty()) return std::nullopt;
  Message message = std::move(under_way_.front());
  under_way_.pop_front();
  return message;
}

void ScriptedRanks::wait() {
  now_s_ += turn_s;
  at(now_s_);
  for (int rank = 0; rank < ranks(); ++rank) work(rank);
}

}  // namespace gigabake
