/// Runs a kernel body on a GPU and on the CPU and compares the results as bytes. Tests are skipped if there is no GPU.
#pragma once

#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/body/tables.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/body/voxelize/coverage.h"
#include "kernels/body/voxelize/window.h"

namespace gigabake::kernels::test {

inline constexpr unsigned seed = 20240611;

inline void check(cudaError_t code, const char* call) {
  if (code != cudaSuccess) throw std::runtime_error(std::string(call) + ": " + cudaGetErrorString(code));
}

inline bool has_device() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}

template <class T>
class DeviceArray {
 public:
  explicit DeviceArray(const std::vector<T>& host) : size_(host.size()) {
    check(cudaMalloc(&data_, size_ * sizeof(T)), "cudaMalloc");
    check(cudaMemcpy(data_, host.data(), size_ * sizeof(T), cudaMemcpyHostToDevice), "cudaMemcpy");
  }
  explicit DeviceArray(const T* host, std::size_t size) : DeviceArray(std::vector<T>(host, host + size)) {}
  ~DeviceArray() { cudaFree(data_); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;
  T* data() const { return data_; }
  std::vector<T> to_host() const {
    std::vector<T> host(size_);
    check(cudaMemcpy(host.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost), "cudaMemcpy");
    return host;
  }

 private:
  T* data_ = nullptr;
  std::size_t size_;
};

template <class Body, class In, class Out>
__global__ void run_body(Body body, const In* in, Out* out, int count, Tables tables) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) out[i] = body(in[i], tables);
}

/// The host's tables in device memory.
class DeviceTables {
 public:
  Tables view() const {
    return {linear_.data(), srgb_.data(), normal_.data(), thesis_.data(), sheet_.data(), code_.data()};
  }

 private:
  Tables host_ = TableStore::host().view();
  DeviceArray<std::uint16_t> linear_{host_.linear_from_srgb, srgb_codes};
  DeviceArray<std::uint8_t> srgb_{host_.srgb_from_linear, linear_values};
  DeviceArray<std::int16_t> normal_{host_.unit_normal, 4 * normal_codes};
  DeviceArray<std::uint8_t> thesis_{host_.thesis_alpha, alpha_sums};
  DeviceArray<std::uint8_t> sheet_{host_.planar_coverage, planar_coverages};
  DeviceArray<std::uint16_t> code_{host_.linear_from_code, srgb_codes};
};

template <class Out, class In, class Body>
std::vector<Out> run_on_device(const std::vector<In>& in, Body body) {
  const DeviceTables tables;
  const DeviceArray<In> device_in(in);
  const DeviceArray<Out> device_out{std::vector<Out>(in.size())};
  run_body<<<int(in.size() + 127) / 128, 128>>>(body, device_in.data(), device_out.data(), int(in.size()),
                                                tables.view());
  check(cudaGetLastError(), "run_body launch");
  check(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
  return device_out.to_host();
}

/// Computes out[i] = body(in[i]) on device and host, and compares the results as bytes.
template <class Out, class In, class Body>
void expect_same_bits(const std::vector<In>& in, Body body) {
  if (!has_device()) GTEST_SKIP() << "no CUDA device";
  const Tables host = TableStore::host().view();
  const std::vector<Out> from_device = run_on_device<Out>(in, body);
  for (std::size_t i = 0; i < in.size(); ++i) {
    Out expected;
    std::memset(&expected, 0, sizeof(Out));
    expected = body(in[i], host);
    ASSERT_EQ(std::memcmp(&expected, &from_device[i], sizeof(Out)), 0) << "item " << i << ", seed " << seed;
  }
}

/// Returns the moments of the polygon about (u, v).
GB_HD CellMoments moments_of(const TrianglePlane& plane, const SlabPolygon& polygon, double u, double v) {
  CellMoments m{};
  for (int e = 0; e < polygon.count; ++e) {
    const int f = e + 1 == polygon.count ? 0 : e + 1;
    add_edge<Moments::second>(polygon.u[e] - u, polygon.v[e] - v, polygon.v[f] - v, plane.line[polygon.line[e]], m);
  }
  return m;
}

/// Returns triangles of all sizes around the brick 0,0,0, many with coordinates on lattice planes.
inline std::vector<WindowTriangle> random_triangles(int count) {
  std::mt19937 random(seed);
  std::vector<WindowTriangle> out;
  while (int(out.size()) < count) {
    const int reach_bits = 6 + int(random() % 22);
    WindowTriangle t{};
    for (auto& p : t.p)
      for (int& x : p) {
        x = int(random() % 2048) + int(random() % (1u << reach_bits)) - (1 << (reach_bits - 1));
        if (random() % 4 == 0) x &= ~255;
      }
    const BrickTriangle<__int128> b = make_brick_triangle<__int128>(t, t.p[0]);
    if (b.n[0] != 0 || b.n[1] != 0 || b.n[2] != 0) out.push_back(t);
  }
  return out;
}

}  // namespace gigabake::kernels::test
