#include "cluster/dispatch/sent_children.h"

#include <utility>

namespace gigabake {

SentChildren::SentChildren(const std::vector<CellJob>& jobs, std::uint64_t max_bytes)
    : jobs_(jobs), overviews_left_(jobs.size(), 0), max_bytes_(max_bytes) {
  for (const CellJob& job : jobs)
    for (const std::uint32_t child : job.children) ++overviews_left_.at(child);
}

void SentChildren::keep(int worker, const CellReport& report, std::vector<std::uint8_t> bytes) {
  if (bytes.empty() || overviews_left_.at(report.id) == 0 || bytes.size() > max_bytes_ - bytes_) return;
  const std::uint64_t size = bytes.size();
  if (sent_.try_emplace(report.id, Sent{worker, {report.cell.file, std::move(bytes)}}).second) bytes_ += size;
}

std::vector<ChildBytes> SentChildren::take_for(std::uint32_t overview, int worker) {
  std::vector<ChildBytes> children;
  for (const std::uint32_t child : jobs_.at(overview).children) {
    const bool is_last = overviews_left_[child] != 0 && --overviews_left_[child] == 0;
    const auto found = sent_.find(child);
    if (found == sent_.end()) continue;
    Sent& sent = found->second;
    if (is_last) bytes_ -= sent.child.bytes.size();
    if (sent.worker != worker) children.push_back(is_last ? std::move(sent.child) : sent.child);
    if (is_last) sent_.erase(found);
  }
  return children;
}

}  // namespace gigabake
