#include "format/source/mesh_parts.h"

#include <algorithm>
#include <bit>

#include "core/base/memory_limit.h"

namespace gigabake {
namespace {

constexpr std::uint32_t word_bits = 64;

/// Returns the `width` values of each vertex in `vertices`; empty if `values` is empty.
template <class T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<std::uint32_t>& vertices, std::size_t width) {
  std::vector<T> out;
  if (values.empty()) return out;
  out.reserve(vertices.size() * width);
  for (const std::uint32_t v : vertices) {
    const auto from = values.begin() + std::ptrdiff_t(v * width);
    out.insert(out.end(), from, from + std::ptrdiff_t(width));
  }
  return out;
}

Primitive part_of(const Primitive& whole, std::uint64_t first_triangle) {
  const std::uint64_t triangles = std::min(whole.index.size() / 3 - first_triangle, max_part_triangles);
  const auto from = whole.index.begin() + std::ptrdiff_t(3 * first_triangle);
  std::vector<std::uint32_t> vertices;
  return with_corners(whole, {from, from + std::ptrdiff_t(3 * triangles)}, vertices);
}

/// A function object that passes one primitive to the sink and returns the number of its parts.
class PartPasser {
 public:
  explicit PartPasser(const PrimitiveSink& sink) : sink_(sink) {}

  int operator()(Primitive&& whole) {
    const std::size_t before = left_.size();
    const std::uint64_t triangles = whole.index.size() / 3;
    if (!is_split(triangles, whole.position.size() / 3)) {
      add(std::move(whole));
    } else {
      for (std::uint64_t first = 0; first == 0 || first < triangles; first += max_part_triangles)
        add(part_of(whole, first));
    }
    return int(left_.size() - before);
  }

  std::vector<Primitive> left() { return std::move(left_); }

 private:
  void add(Primitive&& primitive) {
    left_.push_back(without_lists(primitive));
    sink_(left_.size() - 1, std::move(primitive));
  }

  const PrimitiveSink& sink_;
  std::vector<Primitive> left_;
};

}  // namespace

std::uint64_t part_triangles() {
  constexpr std::uint64_t min_triangles = std::uint64_t(1) << 14, limit_bytes_per_triangle = 1024;
  return std::clamp(memory_limit() / limit_bytes_per_triangle, min_triangles, max_part_triangles);
}

Primitive without_lists(const Primitive& primitive) {
  Primitive out;
  out.position_step = primitive.position_step;
  out.shares_uv = primitive.shares_uv;
  out.material = primitive.material;
  out.voxel_class = primitive.voxel_class;
  out.id_texture = primitive.id_texture;
  return out;
}

Primitive with_corners(const Primitive& whole, std::vector<std::uint32_t>&& index,
                       std::vector<std::uint32_t>& vertices) {
  Primitive out = without_lists(whole);
  out.index = std::move(index);
  const UsedVertices used(out.index);
  used.renumber(out.index);
  vertices = used.ascending();
  out.position = chosen(whole.position, vertices, 3);
  out.uv = chosen(whole.uv, vertices, 2);
  out.rgba = chosen(whole.rgba, vertices, 4);
  out.normal = chosen(whole.normal, vertices, 1);
  out.normal_uv = chosen(whole.normal_uv, vertices, 2);
  out.tangent = chosen(whole.tangent, vertices, 1);
  out.id_uv = chosen(whole.id_uv, vertices, 2);
  return out;
}

UsedVertices::UsedVertices(std::span<const std::uint32_t> corners) {
  if (corners.empty()) return;
  const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
  first_ = *low;
  is_used_.resize((*high - first_) / word_bits + 1);
  before_.resize(is_used_.size());
  for (const std::uint32_t c : corners)
    is_used_[(c - first_) / word_bits] |= std::uint64_t(1) << (c - first_) % word_bits;
  std::uint32_t count = 0;
  for (std::size_t w = 0; w < is_used_.size(); ++w) {
    before_[w] = count;
    count += std::uint32_t(std::popcount(is_used_[w]));
  }
  ascending_.reserve(count);
  for (std::size_t w = 0; w < is_used_.size(); ++w)
    for (std::uint64_t left = is_used_[w]; left != 0; left &= left - 1)
      ascending_.push_back(first_ + std::uint32_t(w) * word_bits + std::uint32_t(std::countr_zero(left)));
}

void UsedVertices::renumber(std::span<std::uint32_t> corners) const {
  for (std::uint32_t& c : corners) {
    const std::uint32_t bit = c - first_;
    const std::uint64_t lower = is_used_[bit / word_bits] & ((std::uint64_t(1) << bit % word_bits) - 1);
    c = before_[bit / word_bits] + std::uint32_t(std::popcount(lower));
  }
}

void pass_on_parts(TileMesh& mesh, const PrimitiveSink& sink) {
  PartPasser hand_over(sink);
  std::vector<int> first, count;
  int sum = 0;
  for (Primitive& primitive : mesh.primitives) {
    first.push_back(sum);
    count.push_back(hand_over(std::move(primitive)));
    sum += count.back();
    primitive = {};
  }
  std::vector<Instance> placed;
  for (const Instance& instance : mesh.instances)
    for (int part = 0; part < count[std::size_t(instance.primitive)]; ++part)
      placed.push_back({first[std::size_t(instance.primitive)] + part, instance.scene_from_local, instance.lod});
  mesh.instances = std::move(placed);
  mesh.primitives = hand_over.left();
}

}  // namespace gigabake
