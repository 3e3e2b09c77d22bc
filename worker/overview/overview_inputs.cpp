#include "worker/overview/overview_inputs.h"

#include <utility>
#include <vector>

namespace gigabake {

void OverviewInputs::keep(const std::string& file, OverviewChild child) {
  const std::uint64_t bytes = bytes_of(child);
  auto kept = std::make_shared<const OverviewChild>(std::move(child));
  std::vector<std::shared_ptr<const OverviewChild>> removed;  // destroyed after the lock is released
  const std::scoped_lock lock(mutex_);
  removed = children_.insert(file, std::move(kept), bytes);
}

std::shared_ptr<const OverviewChild> OverviewInputs::find(const std::string& file) {
  const std::scoped_lock lock(mutex_);
  const auto* child = children_.find_for_last_use(file);
  return child != nullptr ? *child : nullptr;
}

std::uint64_t OverviewInputs::bytes() const {
  const std::scoped_lock lock(mutex_);
  return children_.cost();
}

}  // namespace gigabake
