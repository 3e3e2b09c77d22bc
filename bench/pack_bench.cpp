#include "bench/pack_bench.h"

#include <algorithm>
#include <ctime>
#include <fmt/format.h>
#include <libdeflate.h>
#include <memory>

#include "core/base/error.h"
#include "format/shard/hdf5/file_chunks.h"
#include "kernels/cuda/baker.h"

namespace gigabake::bench {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Returns the CPU time of this thread, so that other programs do not affect it.
double core_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Returns the minimum time of several runs.
template <class Pack>
double timed(int repeats, const Pack& pack) {
  double minimum = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const double begin = core_seconds();
    pack();
    minimum = std::min(minimum, core_seconds() - begin);
  }
  return minimum;
}

/// Returns the chunks.
/// Errors  InputError: there are none.
std::vector<FileChunk> some(std::vector<FileChunk> chunks, const PackBenchRequest& request) {
  if (chunks.empty())
    throw InputError(request.shards, "",
                     fmt::format("its first chunk has more than {} bytes, or there is none: nothing was measured",
                                 request.max_bytes));
  return chunks;
}

std::vector<FileChunk> chunks_of(const PackBenchRequest& request) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(request.shards))
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<FileChunk> all;
  std::uint64_t bytes = 0;
  for (const std::filesystem::path& file : files)
    for (FileChunk& chunk : file_chunks(file)) {
      if ((bytes += chunk.raw.size()) > request.max_bytes) return some(std::move(all), request);
      chunk.filters.codec = Codec::deflate;
      all.push_back(std::move(chunk));
    }
  if (files.empty()) throw InputError(request.shards, "", "holds no shards");
  return some(std::move(all), request);
}

struct FreeCompressor {
  void operator()(libdeflate_compressor* c) const { libdeflate_free_compressor(c); }
};

/// Packs shuffled bytes with libdeflate. The measured time includes shuffling, because the host packer shuffles too. It
/// does not include the checksum.
ColumnPacking by_libdeflate(const FileChunk& chunk, int repeats) {
  const std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor(libdeflate_alloc_compressor(1));
  Bytes bytes(chunk.raw.size()), room(libdeflate_zlib_compress_bound(compressor.get(), chunk.raw.size()));
  ColumnPacking packing;
  packing.libdeflate_seconds = timed(repeats, [&] {
    shuffle_chunk(chunk.raw, chunk.filters.shuffled_bytes, bytes.data());
    packing.libdeflate_bytes =
        libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), room.data(), room.size()) + 4;
  });
  return packing;
}

void add(const ColumnPacking& one, ColumnPacking& to) {
  to.chunks += one.chunks;
  to.raw_bytes += one.raw_bytes;
  to.bytes += one.bytes;
  to.libdeflate_bytes += one.libdeflate_bytes;
  to.seconds += one.seconds;
  to.libdeflate_seconds += one.libdeflate_seconds;
}

/// Packs one chunk on the host, appends it to `all`, and unpacks it again.
ColumnPacking by_host(const FileChunk& chunk, int repeats, Bytes& all, bool& differ) {
  ColumnPacking packing = by_libdeflate(chunk, repeats);
  Bytes stored;
  packing.seconds = timed(repeats, [&] { stored = encode_chunk(chunk.raw, chunk.filters); });
  packing.chunks = 1;
  packing.raw_bytes = chunk.raw.size();
  packing.bytes = stored.size();
  Bytes back(chunk.raw.size());
  differ |= !decode_chunk(stored, chunk.filters, back.size(), back) || back != chunk.raw;
  all.insert(all.end(), stored.begin(), stored.end());
  return packing;
}

void pack_by_device(const std::vector<FileChunk>& chunks, int repeats, const Bytes& host, PackBench& out) {
  const kernels::CudaDevices devices = kernels::cuda_devices();
  out.device_reason = devices.usable.empty() ? devices.reason : "";
  if (devices.usable.empty()) return;
  Bytes raw;
  std::vector<kernels::RawChunk> places;
  for (const FileChunk& c : chunks) {
    places.push_back(
        {raw.size(), std::uint32_t(c.raw.size()), std::uint32_t(c.filters.shuffled_bytes), c.filters.min_match_bytes});
    raw.insert(raw.end(), c.raw.begin(), c.raw.end());
  }
  out.device = kernels::pack_on_device(devices.usable.front(), raw, places, std::max(2, repeats));
  out.differ |= out.device.bytes != host;
}

}  // namespace

double PackBench::device_seconds() const { return *std::min_element(device.seconds.begin(), device.seconds.end()); }

PackBench bench_pack(const PackBenchRequest& request) {
  const std::vector<FileChunk> chunks = chunks_of(request);
  PackBench out;
  Bytes host;
  for (const FileChunk& chunk : chunks) {
    const ColumnPacking packing = by_host(chunk, request.repeats, host, out.differ);
    add(packing, out.columns[chunk.column]);
    add(packing, out.all);
  }
  pack_by_device(chunks, request.repeats, host, out);
  return out;
}

}  // namespace gigabake::bench
