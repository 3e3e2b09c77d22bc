/// A cell's triangles, materials and textures on the device.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <unordered_map>
#include <vector>

#include "kernels/body/cell.h"
#include "kernels/body/tables.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/body/voxelize/cell_materials.h"
#include "kernels/body/voxelize/classify_triangle.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/window.h"
#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {

/// A submesh on the device. Vertices and triangles are numbered consecutively over all submeshes.
struct DevicePart : PartArrays {
  std::uint32_t first_vertex, first_triangle;
};

/// The input of a cell as kernels receive it by value.
struct InputView {
  const DevicePart* parts;
  const MaterialView* materials;
  const TextureView* textures;
  const SnappedVertex* vertices;  ///< [vertex of all submeshes]; null if vertices are snapped on every access
  const SnapWindow* window;
  Tables tables;
  std::uint32_t part_count, vertex_count, triangle_count;
};

/// Returns the submesh that contains vertex or triangle `i`, numbered over all submeshes. `first` is
/// &DevicePart::first_vertex or &DevicePart::first_triangle.
template <std::uint32_t DevicePart::*first>
__device__ inline std::uint32_t part_of(const InputView& in, std::uint32_t i) {
  std::uint32_t low = 0, high = in.part_count;
  while (high - low > 1) {
    const std::uint32_t middle = (low + high) / 2;
    (in.parts[middle].*first <= i ? low : high) = middle;
  }
  return low;
}

/// Snaps a vertex on access. Never inlined: few cells need it, and inlined copies would crowd the instruction cache.
__device__ __noinline__ inline SnappedVertex snap_vertex_now(const SnapWindow* window, const DevicePart* part,
                                                             std::uint32_t vertex) {
  return snap_vertex(*window, *part, vertex);
}

__device__ inline SnappedVertex snapped_vertex(const InputView& in, const DevicePart& part, std::uint32_t vertex) {
  return in.vertices != nullptr ? in.vertices[part.first_vertex + vertex] : snap_vertex_now(in.window, &part, vertex);
}

/// Returns a triangle in window coordinates. `triangle` is numbered over all submeshes. All its vertices must lie on
/// the lattice.
__device__ inline WindowTriangle window_triangle(const InputView& in, std::uint32_t triangle) {
  WindowTriangle t;
  t.part = part_of<&DevicePart::first_triangle>(in, triangle);
  const DevicePart& part = in.parts[t.part];
  t.index = triangle - part.first_triangle;
  std::uint32_t v[3];
  triangle_vertices(part, t.index, v);
  for (int i = 0; i < 3; ++i) t.p[i] = snapped_vertex(in, part, v[i]);
  return t;
}

struct DeviceTexture {
  std::uint64_t id = 0;
  DeviceArray<std::uint8_t> texels;
  TextureView view;  ///< with device pointers
};

/// LRU cache of recent cells' textures. Evicts textures beyond the budget; a cell that refers to an evicted texture
/// keeps it alive.
class DeviceTextures {
 public:
  DeviceTextures(DeviceHeap& heap, std::uint64_t budget_bytes) : heap_(heap), budget_(budget_bytes) {}
  std::shared_ptr<const DeviceTexture> get(const TextureView& host);

 private:
  using Entry = std::shared_ptr<const DeviceTexture>;
  void make_room(std::uint64_t bytes);

  DeviceHeap& heap_;
  std::uint64_t budget_, used_ = 0;
  std::list<Entry> entries_;  ///< most recently used first
  std::unordered_map<std::uint64_t, std::list<Entry>::iterator> by_id_;
};

/// Copy of TableStore::host() on the device.
class DeviceTables {
 public:
  explicit DeviceTables(DeviceHeap& heap);
  Tables view() const;

 private:
  DeviceArray<std::uint16_t> linear_from_srgb_, linear_from_code_;
  DeviceArray<std::uint8_t> srgb_from_linear_, thesis_alpha_, planar_coverage_;
  DeviceArray<std::int16_t> unit_normal_;
};

/// Input of one cell. Arrays that several submeshes share are uploaded once.
class DeviceInput {
 public:
  /// Errors  CudaFailure; std::length_error beyond 2^32-1 vertices or triangles.
  DeviceInput(DeviceHeap& heap, const CellInput& input, DeviceTextures& textures, const Tables& tables);
  InputView view() const;
  CellMaterials materials() const { return cell_materials_; }
  std::uint64_t bytes() const { return arrays_.bytes(); }  ///< without textures
  std::uint64_t bytes_with_textures() const;

 private:
  std::uint32_t vertex_count_ = 0, triangle_count_ = 0;
  CellMaterials cell_materials_ = CellMaterials::any;
  Tables tables_;
  DeviceArray<std::uint8_t> arrays_;
  DeviceArray<DevicePart> parts_;
  DeviceArray<MaterialView> materials_;
  DeviceArray<TextureView> textures_;
  std::vector<std::shared_ptr<const DeviceTexture>> held_;
};

}  // namespace gigabake::kernels
