#include <cstring>
#include <limits>
#include <stdexcept>

#include "kernels/cuda/device/input.cuh"

namespace gigabake::kernels {
namespace {

constexpr std::size_t alignment = 256;

std::size_t aligned(std::size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }

/// Host arrays packed one after the other into one device array; an array that was added twice is stored once.
class Layout {
 public:
  template <class T>
  void add(Span<const T> span) {
    if (span.empty() || !offset_.try_emplace(span.data, bytes_).second) return;
    pieces_.push_back({span.data, span.size * sizeof(T)});
    bytes_ += aligned(span.size * sizeof(T));
  }
  DeviceArray<std::uint8_t> upload(DeviceHeap& heap) const {
    DeviceArray<std::uint8_t> array(heap, bytes_);
    for (const Piece& p : pieces_)
      upload_async(array.data() + offset_.at(p.host), p.host, p.bytes, heap.stream(), "cudaMemcpyAsync (mesh)");
    return array;
  }
  template <class T>
  const T* address(const DeviceArray<std::uint8_t>& array, Span<const T> span) const {
    return span.empty() ? nullptr : reinterpret_cast<const T*>(array.data() + offset_.at(span.data));
  }

 private:
  struct Piece {
    const void* host;
    std::size_t bytes;
  };
  std::vector<Piece> pieces_;
  std::unordered_map<const void*, std::size_t> offset_;
  std::size_t bytes_ = 0;
};

std::uint32_t counted(std::size_t sum, const char* what) {
  if (sum > std::numeric_limits<std::uint32_t>::max())
    throw std::length_error(std::string("a cell of more than 2^32-1 ") + what + "; use a smaller `cell_voxels`");
  return std::uint32_t(sum);
}

std::size_t level_bytes(const TextureView& t, int l) {
  const std::size_t texels = std::size_t(level_extent(t.width, l)) * std::size_t(level_extent(t.height, l));
  return texels * (l == 0 ? 4 : 8);
}

std::size_t texture_bytes(const TextureView& t) {
  std::size_t bytes = 0;
  for (int l = 0; l < t.levels; ++l) bytes += aligned(level_bytes(t, l));
  return bytes;
}

}  // namespace

std::shared_ptr<const DeviceTexture> DeviceTextures::get(const TextureView& host) {
  if (const auto found = by_id_.find(host.id); found != by_id_.end()) {
    entries_.splice(entries_.begin(), entries_, found->second);
    return entries_.front();
  }
  const std::size_t bytes = texture_bytes(host);
  make_room(bytes);
  auto texture = std::make_shared<DeviceTexture>();
  texture->id = host.id;
  texture->texels = DeviceArray<std::uint8_t>(heap_, bytes);
  texture->view = host;
  std::size_t at = 0;
  for (int l = 0; l < host.levels; ++l) {
    const void* from = l == 0 ? static_cast<const void*>(host.base) : host.level[l];
    std::uint8_t* to = texture->texels.data() + at;
    upload_async(to, from, level_bytes(host, l), heap_.stream(), "cudaMemcpyAsync (texture)");
    if (l == 0)
      texture->view.base = to;
    else
      texture->view.level[l] = reinterpret_cast<const std::uint16_t*>(to);
    at += aligned(level_bytes(host, l));
  }
  used_ += bytes;
  entries_.push_front(texture);
  by_id_[host.id] = entries_.begin();
  return texture;
}

void DeviceTextures::make_room(std::uint64_t bytes) {
  while (!entries_.empty() && used_ + bytes > budget_) {
    used_ -= entries_.back()->texels.bytes();
    by_id_.erase(entries_.back()->id);
    entries_.pop_back();
  }
}

DeviceTables::DeviceTables(DeviceHeap& heap) {
  const Tables host = TableStore::host().view();
  linear_from_srgb_ = uploaded(heap, host.linear_from_srgb, srgb_codes);
  srgb_from_linear_ = uploaded(heap, host.srgb_from_linear, linear_values);
  unit_normal_ = uploaded(heap, host.unit_normal, 4 * normal_codes);
  thesis_alpha_ = uploaded(heap, host.thesis_alpha, alpha_sums);
  planar_coverage_ = uploaded(heap, host.planar_coverage, planar_coverages);
  linear_from_code_ = uploaded(heap, host.linear_from_code, srgb_codes);
}

Tables DeviceTables::view() const {
  return {linear_from_srgb_.data(), srgb_from_linear_.data(), unit_normal_.data(),
          thesis_alpha_.data(),     planar_coverage_.data(),  linear_from_code_.data()};
}

DeviceInput::DeviceInput(DeviceHeap& heap, const CellInput& input, DeviceTextures& textures, const Tables& tables)
    : tables_(tables) {
  Layout layout;
  for (std::size_t i = 0; i < input.parts.size; ++i) {
    const PartView& p = input.parts[i];
    layout.add(p.position);
    layout.add(p.index);
    layout.add(p.uv);
    layout.add(p.rgba);
    layout.add(p.normal);
    layout.add(p.normal_uv);
    layout.add(p.tangent);
  }
  arrays_ = layout.upload(heap);
  std::vector<DevicePart> parts;
  for (std::size_t i = 0; i < input.parts.size; ++i) {
    const PartView& p = input.parts[i];
    DevicePart d{part_arrays(input, p), vertex_count_, triangle_count_};
    d.position = layout.address(arrays_, p.position);
    d.index = layout.address(arrays_, p.index);
    d.uv = layout.address(arrays_, p.uv);
    d.rgba = layout.address(arrays_, p.rgba);
    d.normal = reinterpret_cast<const std::int16_t*>(layout.address(arrays_, p.normal));
    d.normal_uv = layout.address(arrays_, p.normal_uv);
    d.tangent = reinterpret_cast<const std::int16_t*>(layout.address(arrays_, p.tangent));
    parts.push_back(d);
    vertex_count_ = counted(std::size_t(vertex_count_) + p.position.size / 3, "vertices");
    triangle_count_ = counted(std::size_t(triangle_count_) + p.index.size / 3, "triangles");
  }
  parts_ = uploaded(heap, parts.data(), parts.size());
  materials_ = uploaded(heap, input.materials.data, input.materials.size);
  std::vector<TextureView> views;
  for (std::size_t i = 0; i < input.textures.size; ++i) {
    held_.push_back(textures.get(input.textures[i]));
    views.push_back(held_.back()->view);
  }
  textures_ = uploaded(heap, views.data(), views.size());
  cell_materials_ = materials_in(input);
  wait_for(heap.stream(), "cudaStreamSynchronize (upload)");  // host arrays may be freed now
}

std::uint64_t DeviceInput::bytes_with_textures() const {
  std::uint64_t all = bytes();
  for (const auto& texture : held_) all += texture->texels.bytes();
  return all;
}

InputView DeviceInput::view() const {
  return {parts_.data(), materials_.data(), textures_.data(), nullptr, nullptr, tables_, std::uint32_t(parts_.size()),
          vertex_count_, triangle_count_};
}

}  // namespace gigabake::kernels
