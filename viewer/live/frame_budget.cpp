#include "viewer/live/frame_budget.h"

#include <algorithm>
#include <cmath>

namespace gigabake {

FrameBudget::FrameBudget(double target_s) : target_s_(target_s > 0 && std::isfinite(target_s) ? target_s : 0.05) {}

void FrameBudget::took(double seconds, double share) {
  if (!(seconds > 0) || !std::isfinite(seconds) || !(share > 0) || !std::isfinite(share)) return;
  const double full_s = seconds / (share * share);
  full_s_ = full_s_ > 0 ? 0.6 * full_s_ + 0.4 * full_s : full_s;
  const double requested = std::sqrt(target_s_ / full_s_);
  // The size shrinks at once but grows only by a clear margin: size changes disturb more than a small image.
  if (requested < share_ || requested > share_ * 1.15)
    share_ = std::clamp(std::floor(requested * 32) / 32, min_share, 1.0);
}

}  // namespace gigabake
