#include "sample/terrain/near_grid.h"

#include <algorithm>

namespace gigabake::sample {

NearGrid::NearGrid(double size_m, double reach_m)
    : reach_m_(reach_m), low_m_(-size_m / 2 - reach_m), bucket_m_(std::max(reach_m, size_m / 512)) {
  buckets_ = int((size_m + 2 * reach_m) / bucket_m_) + 1;
  items_.resize(std::size_t(buckets_) * std::size_t(buckets_));
}

int NearGrid::bucket(double coordinate_m) const {
  return std::clamp(int((coordinate_m - low_m_) / bucket_m_), 0, buckets_ - 1);
}

void NearGrid::add(MapPoint min, MapPoint max, int item) {
  const int x_end = bucket(max.e_m + reach_m_), y_end = bucket(max.n_m + reach_m_);
  for (int y = bucket(min.n_m - reach_m_); y <= y_end; ++y)
    for (int x = bucket(min.e_m - reach_m_); x <= x_end; ++x)
      items_[std::size_t(y) * std::size_t(buckets_) + std::size_t(x)].push_back(item);
}

std::span<const int> NearGrid::near(MapPoint p) const {
  return items_[std::size_t(bucket(p.n_m)) * std::size_t(buckets_) + std::size_t(bucket(p.e_m))];
}

}  // namespace gigabake::sample
