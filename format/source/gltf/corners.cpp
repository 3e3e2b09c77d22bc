#include "format/source/gltf/corners.h"

#include <algorithm>
#include <numeric>

#include "core/base/error.h"
#include "core/base/pluralize.h"

namespace gigabake {

Corners::Corners(const std::filesystem::path& file, const GltfDocument& document, const tinygltf::Primitive& primitive,
                 const std::string& where, std::uint64_t vertices)
    : file_(file),
      where_(where),
      vertices_(vertices),
      drawn_(vertices),
      mode_(primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode) {
  if (primitive.indices >= 0) {
    indices_.emplace(file, document, primitive.indices);
    if (!indices_->is_index()) throw InputError(file_, where_ + ".indices", "expected unsigned integers");
    drawn_ = indices_->count();
  }
  if (mode_ == TINYGLTF_MODE_TRIANGLES && drawn_ % 3 != 0)
    throw InputError(file_, where_, pluralize(drawn_, "vertex is", "vertices are") + " no whole number of triangles");
}

std::uint64_t Corners::triangles() const {
  if (mode_ == TINYGLTF_MODE_TRIANGLES) return drawn_ / 3;
  return drawn_ < 3 ? 0 : drawn_ - 2;
}

std::vector<std::uint32_t> Corners::in_order(std::uint64_t first, std::uint64_t count) const {
  if (!indices_) {
    std::vector<std::uint32_t> out(count);
    std::iota(out.begin(), out.end(), std::uint32_t(first));
    return out;
  }
  std::vector<std::uint32_t> out = indices_->indices(first, count);
  const auto bad = std::find_if(out.begin(), out.end(), [this](std::uint32_t v) { return v >= vertices_; });
  if (bad != out.end())
    throw InputError(file_, where_ + ".indices",
                     "index " + std::to_string(first + std::uint64_t(bad - out.begin())) + " is " +
                         std::to_string(*bad) + ", beyond the " + pluralize(vertices_, "vertex", "vertices"));
  return out;
}

std::vector<std::uint32_t> Corners::of_triangles(std::uint64_t first, std::uint64_t count) const {
  if (mode_ == TINYGLTF_MODE_TRIANGLES) return in_order(3 * first, 3 * count);
  if (count == 0) return check(), std::vector<std::uint32_t>();
  const bool is_fan = mode_ == TINYGLTF_MODE_TRIANGLE_FAN;
  const std::vector<std::uint32_t> order = in_order(first, count + 2);
  const std::uint32_t hub = is_fan ? in_order(0, 1)[0] : 0;
  std::vector<std::uint32_t> out;
  out.reserve(3 * count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t odd = (first + i) % 2;
    if (is_fan)
      out.insert(out.end(), {order[i + 1], order[i + 2], hub});
    else
      out.insert(out.end(), {order[i], order[i + 1 + odd], order[i + 2 - odd]});
  }
  return out;
}

void Corners::check() const {
  constexpr std::uint64_t block = std::uint64_t(1) << 20;
  if (!indices_) return;
  for (std::uint64_t first = 0; first < drawn_; first += block) in_order(first, std::min(block, drawn_ - first));
}

}  // namespace gigabake
