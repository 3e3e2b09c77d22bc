#include "worker/overview/overview_inputs.h"

#include <utility>

namespace gigabake {

void OverviewInputs::keep(const std::string& file, ChildOfParent child) {
  const std::uint64_t bytes = bytes_of(child);
  auto kept = std::make_shared<const ChildOfParent>(std::move(child));
  const std::scoped_lock lock(mutex_);
  if (const auto found = by_file_.find(file); found != by_file_.end()) erase(found->second);
  if (bytes > budget_bytes_) return;
  while (bytes_ + bytes > budget_bytes_) erase(entries_.begin());
  by_file_[file] = entries_.insert(entries_.end(), {file, std::move(kept), bytes});
  bytes_ += bytes;
}

std::shared_ptr<const ChildOfParent> OverviewInputs::find(const std::string& file) {
  const std::scoped_lock lock(mutex_);
  const auto found = by_file_.find(file);
  if (found == by_file_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->child;
}

std::uint64_t OverviewInputs::bytes() const {
  const std::scoped_lock lock(mutex_);
  return bytes_;
}

void OverviewInputs::erase(std::list<Entry>::iterator entry) {
  bytes_ -= entry->bytes;
  by_file_.erase(entry->file);
  entries_.erase(entry);
}

}  // namespace gigabake
