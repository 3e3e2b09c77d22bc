#include <algorithm>
#include <cstring>

#include "kernels/cuda/device/download_ring.cuh"
#include "kernels/cuda/device/memory.cuh"

namespace gigabake::kernels {
namespace {

/// Sizes of a piece, and of the bytes of a piece that one thread copies. A transfer of one piece takes about 80 µs, and
/// the threads copy a piece in about the same time.
constexpr std::size_t bytes_per_piece = 1u << 22, bytes_per_thread = 1u << 18;

}  // namespace

std::vector<DownloadRing::Piece> DownloadRing::pieces_of(std::span<const Part> parts) {
  std::size_t bytes = 0;
  for (const Part& part : parts) bytes += part.bytes;
  std::byte* arrived = room_.reserve(bytes);
  std::vector<Piece> pieces;
  for (const Part& part : parts)
    for (std::size_t at = 0; at < part.bytes; at += bytes_per_piece) {
      const std::size_t size = std::min(bytes_per_piece, part.bytes - at);
      pieces.push_back(
          {static_cast<std::byte*>(part.host) + at, arrived, static_cast<const std::byte*>(part.device) + at, size});
      arrived += size;
    }
  return pieces;
}

cudaEvent_t DownloadRing::arrival_of(std::size_t piece) {
  if (piece == arrivals_.size()) arrivals_.emplace_back();
  return arrivals_[piece].handle;
}

void DownloadRing::bring(std::span<const Part> parts) {
  const std::vector<Piece> pieces = pieces_of(parts);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    download_async(piece.arrived, piece.device, piece.bytes, stream_, "cudaMemcpyAsync");
    check_cuda(cudaEventRecord(arrival_of(i), stream_), "cudaEventRecord");
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Piece& piece = pieces[i];
    wait_for(arrivals_[i].handle, "cudaEventSynchronize");
    pool_.parallel_for(piece.bytes, bytes_per_thread, [&](std::size_t begin, std::size_t end, int) {
      std::memcpy(piece.host + begin, piece.arrived + begin, end - begin);
    });
  }
}

}  // namespace gigabake::kernels
