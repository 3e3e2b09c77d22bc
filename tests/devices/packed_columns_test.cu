// A device packs the same columns as the host, byte by byte: for random levels and for all test cells of the kernels.
// The tests are skipped, with the reason, if there is no GPU.
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "core/codec/chunk_rows.h"
#include "format/shard/columns/shard_columns.h"
#include "format/shard/packed_shard.h"
#include "kernels/body/prune/node.h"
#include "kernels/cpu/prune/prune.h"
#include "kernels/cuda/cell.cuh"
#include "kernels/cuda/device/stream.cuh"
#include "kernels/pack/packer.h"
#include "tests/kernels/cuda_scenes.h"
#include "tests/kernels/made_tree.h"
#include "tests/random_seed.h"
#include "worker/pipeline/shard_from_volume.h"

namespace gigabake {
namespace {

ShardHeader header_of(bool normals, bool directional_coverage, std::uint32_t cell_voxels) {
  ShardHeader header;
  header.cell_voxels = cell_voxels;
  header.has_normals = normals;
  header.has_directional_coverage = directional_coverage;
  return header;
}

kernels::PackRequest request_of(const ShardHeader& header, std::size_t lods) {
  kernels::PackRequest request;
  for (std::size_t lod = 0; lod < lods; ++lod) request.levels.push_back(level_columns(header, int(lod)));
  request.nodes = packed_nodes(header);
  return request;
}

/// Returns chunk `number` of the column in the form in which the host stores it.
std::vector<std::uint8_t> stored_chunk(const ColumnRows& column, std::size_t number) {
  const std::size_t row = column.column.row_bytes(), per_chunk = rows_per_chunk(column.rows, row);
  const std::size_t first = number * per_chunk, rows = std::min<std::size_t>(per_chunk, column.rows - first);
  std::vector<std::uint8_t> scratch;
  const auto raw = column.get(first, rows, scratch);
  std::vector<std::uint8_t> whole(raw.begin(), raw.end());
  whole.resize(per_chunk * row);
  return encode_chunk(whole, column.column.filters(Codec::deflate));
}

/// Compares chunks in their stored form. Returns the first difference, or an empty string.
std::string stored_difference(const ColumnRows& host, std::span<const std::span<const std::uint8_t>> device,
                              const ThreadPool& pool) {
  const std::size_t chunks = chunk_count(host.rows, host.column.row_bytes());
  if (device.size() != chunks)
    return std::to_string(chunks) + " chunks, on the device " + std::to_string(device.size());
  std::vector<std::uint8_t> differs(chunks);
  pool.parallel_for(chunks, 1, [&](std::size_t i, std::size_t, int) {
    const std::vector<std::uint8_t> of_host = stored_chunk(host, i);
    differs[i] = !std::equal(of_host.begin(), of_host.end(), device[i].begin(), device[i].end());
  });
  const auto first = std::find(differs.begin(), differs.end(), 1);
  if (first == differs.end()) return "";
  return "chunk " + std::to_string(first - differs.begin()) + " of " + std::to_string(chunks) + " differs";
}

/// Compares names, rows and bytes of the columns. Returns the first difference, or an empty string.
std::string difference(std::span<const ColumnRows> host, std::span<const ColumnRows> device, const ThreadPool& pool) {
  if (host.size() != device.size())
    return std::to_string(host.size()) + " columns, on the device " + std::to_string(device.size());
  for (std::size_t c = 0; c < host.size(); ++c) {
    const std::string& name = host[c].column.name;
    if (name != device[c].column.name) return name + ", on the device " + device[c].column.name;
    if (host[c].rows != device[c].rows)
      return name + " has " + std::to_string(host[c].rows) + " rows, on the device " + std::to_string(device[c].rows);
    if (host[c].rows == 0) continue;
    if (!device[c].stored.empty()) {
      const std::string stored = stored_difference(host[c], device[c].stored, pool);
      if (!stored.empty()) return name + ": " + stored;
      continue;
    }
    std::vector<std::uint8_t> a, b;
    const auto of_host = host[c].get(0, host[c].rows, a), of_device = device[c].get(0, host[c].rows, b);
    const auto at = std::mismatch(of_host.begin(), of_host.end(), of_device.begin(), of_device.end());
    if (at.first != of_host.end())
      return name + " differs at byte " + std::to_string(at.first - of_host.begin()) + " of " +
             std::to_string(of_host.size());
  }
  return "";
}

class DevicePack : public testing::Test {
 protected:
  void SetUp() override {
    const kernels::CudaDevices devices = kernels::cuda_devices();
    if (devices.usable.empty()) GTEST_SKIP() << devices.reason;
    device_ = devices.usable[0];
    packer_ = std::make_unique<kernels::CudaPacker>(device_);
    baker_ = std::make_unique<kernels::CudaBaker>(device_, std::uint64_t(64) << 20);
  }

  /// Expects the packers of host and device to return equal columns for the same levels.
  void expect_same_columns(const ShardHeader& header, const NodeTable& nodes, const std::vector<BrickLevel>& levels,
                           const kernels::CudaVolume& volume) {
    for (const kernels::ColumnBytes as : {kernels::ColumnBytes::raw, kernels::ColumnBytes::stored}) {
      kernels::PackRequest request = request_of(header, levels.size());
      request.as = as;
      const std::optional<kernels::PackedCell> packed = packer_->pack(volume, request);
      ASSERT_TRUE(packed);
      expect_same_columns(header, nodes, levels, *packed);
    }
  }

  void expect_same_columns(const ShardHeader& header, const NodeTable& nodes, const std::vector<BrickLevel>& levels,
                           const kernels::PackedCell& packed) {
    ShardColumns host(header), device(header);
    host.add_nodes(nodes);
    device.add_nodes(packed.nodes);
    host.add_levels(nodes, levels, pool_);
    for (const PackedLevel& level : packed.levels) device.add_level(level);
    EXPECT_EQ(difference(host.columns(), device.columns(), pool_), "");
    for (std::size_t l = 0; l < levels.size(); ++l) {
      std::array<std::uint64_t, 256> alphas{};
      for (std::size_t i = 3; i < levels[l].rgba.size(); i += 4) ++alphas[levels[l].rgba[i]];
      EXPECT_EQ(packed.levels[l].alphas, alphas) << "lod " << l;
    }
  }

  int device_ = 0;
  ThreadPool pool_{8};
  std::unique_ptr<kernels::CudaPacker> packer_;
  std::unique_ptr<kernels::CudaBaker> baker_;
};

void add_values(std::mt19937_64& rng, const BrickLevel& level, std::size_t width, std::vector<std::uint8_t>& bytes) {
  const bool all_alike = rng() % 6 == 0, many_plain = rng() % 3 == 0;
  for (std::size_t b = 0; b + 1 < level.first.size(); ++b) {
    const unsigned shift = many_plain ? 0 : unsigned(rng() % 4);
    std::map<unsigned, std::uint32_t> value;
    for (unsigned z = 0; z < 8; ++z)
      for (std::uint64_t rest = level.mask[8 * b + z]; rest != 0; rest &= rest - 1) {
        const auto bit = unsigned(__builtin_ctzll(rest));
        const unsigned place = (bit & 7) >> shift | (bit >> 3) >> shift << 3 | z >> shift << 6;
        if (!value.count(place)) value[place] = std::uint32_t(rng());
        for (std::size_t i = 0; i < width; ++i)
          bytes.push_back(all_alike ? std::uint8_t(7 * i) : std::uint8_t(value[place] >> 8 * i));
      }
  }
}

BrickLevel made_level(std::mt19937_64& rng, std::size_t bricks, bool normals, bool directional_coverage) {
  BrickLevel level;
  level.first.push_back(0);
  for (std::size_t b = 0; b < bricks; ++b) {
    const unsigned density = unsigned(rng() % 4);
    std::uint64_t voxels = 0;
    for (unsigned z = 0; z < 8; ++z) {
      std::uint64_t word = density == 0 ? ~std::uint64_t(0) : density == 1 ? rng() : rng() & rng() & rng();
      if (density == 3 && z != b % 8) word = 0;
      if (z == b % 8) word |= std::uint64_t(1) << rng() % 64;
      level.mask.push_back(word);
      voxels += std::uint64_t(__builtin_popcountll(word));
    }
    level.first.push_back(level.first.back() + voxels);
  }
  add_values(rng, level, 4, level.rgba);
  std::vector<std::uint8_t> normal;
  if (normals) add_values(rng, level, 2, normal);
  level.normal.assign(normal.begin(), normal.end());
  if (!directional_coverage) return level;
  add_values(rng, level, directional_coverage_bytes, level.directional_coverage);
  const bool is_complete = rng() % 4 == 0;  // coverages also of voxels whose planes are complete
  for (std::size_t v = 0; v < level.directional_coverage.size(); v += directional_coverage_bytes)
    if (!stores_coverage(level.directional_coverage[v + directional_coverage_plane], is_complete))
      std::fill_n(&level.directional_coverage[v], coverage_bytes, std::uint8_t(0));
  return level;
}

template <class T, class From>
kernels::DeviceArray<T> uploaded(kernels::DeviceHeap& heap, const std::vector<From>& from) {
  kernels::DeviceArray<T> to(heap, from.size() * sizeof(From) / sizeof(T));
  EXPECT_EQ(cudaMemcpy(to.data(), from.data(), to.bytes(), cudaMemcpyHostToDevice), cudaSuccess);
  return to;
}

kernels::DeviceLevel on_device(kernels::DeviceHeap& heap, const BrickLevel& level) {
  kernels::DeviceLevel out;
  out.bricks = std::uint32_t(level.mask.size() / 8);
  out.voxels = std::uint32_t(level.first.back());
  out.mask = uploaded<std::uint64_t>(heap, level.mask);
  out.first = uploaded<std::uint32_t>(heap, std::vector<std::uint32_t>(level.first.begin(), level.first.end()));
  out.key = uploaded<std::uint32_t>(heap, std::vector<std::uint32_t>(out.bricks));
  out.rgba = uploaded<std::uint32_t>(heap, level.rgba);
  if (!level.normal.empty()) out.normal = uploaded<std::uint16_t>(heap, level.normal);
  if (!level.directional_coverage.empty())
    out.directional_coverage = uploaded<std::uint8_t>(heap, level.directional_coverage);
  return out;
}

NodeTable one_node() {
  NodeTable nodes;
  nodes.key = {0};
  nodes.lod = {0};
  nodes.child_mask = {0};
  nodes.first_child = {0};
  nodes.value = {0};
  kernels::set_all_bricks(nodes, 1);
  return nodes;
}

/// Uploads a baked cell of these levels. Its nodes and keys form no tree.
void put_on_device(kernels::DeviceHeap& heap, const std::vector<BrickLevel>& levels, kernels::BakedCell& cell) {
  for (const BrickLevel& level : levels) cell.levels.push_back(on_device(heap, level));
  cell.nodes.count = 1;
  const std::vector<std::uint32_t> none(1);
  const std::vector<std::uint8_t> no_byte(1);
  cell.nodes.key = uploaded<std::uint32_t>(heap, none);
  cell.nodes.first_child = uploaded<std::uint32_t>(heap, none);
  cell.nodes.value = uploaded<std::uint32_t>(heap, none);
  cell.nodes.lod = uploaded<std::uint8_t>(heap, no_byte);
  cell.nodes.child_mask = uploaded<std::uint8_t>(heap, no_byte);
  EXPECT_EQ(cudaStreamSynchronize(heap.stream()), cudaSuccess);
}

TEST_F(DevicePack, MakesTheHostsColumnsOfRandomLevels) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const kernels::Stream stream(device_);
  kernels::DeviceMemoryStats memory_stats;
  kernels::DeviceHeap heap(stream.handle, memory_stats);
  for (int round = 0; round < 60 && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const bool normals = rng() % 3 != 0, directional_coverage = rng() % 3 != 0;
    std::vector<BrickLevel> levels;
    const std::size_t lods = 1 + rng() % 6;
    for (std::size_t lod = 0; lod < lods; ++lod)
      levels.push_back(made_level(rng, 1 + rng() % (rng() % 4 == 0 ? 5000 : 20), normals,
                                  directional_coverage && (lod > 0 || normals)));
    kernels::BakedCell cell;
    put_on_device(heap, levels, cell);
    expect_same_columns(header_of(normals, directional_coverage, 8u << (lods - 1)), one_node(), levels, cell);
  }
}

/// Columns of more than 1024 chunks of 128 KiB have larger chunks.
TEST_F(DevicePack, MakesTheHostsColumnsOfMoreThanAThousandChunks) {
  std::mt19937_64 rng(5);
  const kernels::Stream stream(device_);
  kernels::DeviceMemoryStats memory_stats;
  kernels::DeviceHeap heap(stream.handle, memory_stats);
  BrickLevel level;
  level.first.push_back(0);
  constexpr std::size_t bricks = 100'000;  // full: 51 million voxels, 154 MB of colours
  level.mask.assign(8 * bricks, ~std::uint64_t(0));
  for (std::size_t b = 0; b < bricks; ++b) level.first.push_back(512 * (b + 1));
  level.rgba.resize(4 * level.first.back());
  for (std::size_t i = 0; i < level.rgba.size(); ++i)
    level.rgba[i] = i % 4 == 3 ? 255 : std::uint8_t(i * 2654435761u >> 13);
  kernels::BakedCell cell;
  put_on_device(heap, {level}, cell);
  expect_same_columns(header_of(false, false, 8), one_node(), {level}, cell);
}

TEST_F(DevicePack, MakesTheHostsColumnsOfEveryRuleFilterAndChannel) {
  std::list<kernels::test::TestCell> cells = kernels::test::all_cells();
  int packed = 0, with_constants = 0;
  for (kernels::test::TestCell& cell : cells)
    for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin})
      for (const MipFilter filter : {MipFilter::coverage, MipFilter::thesis, MipFilter::box})
        for (const bool all_channels : {true, false}) {
          SCOPED_TRACE(cell.name + ", rule " + std::to_string(int(rule)) + ", filter " + std::to_string(int(filter)));
          kernels::CellParameters parameters = cell.parameters(rule, filter, all_channels);
          parameters.directional_coverage = all_channels;
          parameters.max_error = rule == SurfaceRule::thin ? 3 : 0;
          const auto input = baker_->upload(cell.input());
          std::unique_ptr<kernels::CudaVolume> volume = baker_->bake(*input, parameters);
          const ShardHeader header =
              header_of(all_channels, all_channels && filter == MipFilter::coverage, parameters.window_voxels);
          const std::optional<kernels::PackedCell> columns = packer_->pack(*volume, request_of(header, 12));
          ASSERT_TRUE(columns);
          ++packed;
          with_constants += columns->constants.kind.empty() ? 0 : 1;
          std::unique_ptr<kernels::CudaVolume> again = baker_->bake(*input, parameters);
          const kernels::CellVolume host = baker_->download(std::move(again));
          EXPECT_EQ(host.content_hash, columns->content_hash);
          EXPECT_EQ(host.above, columns->above);
          expect_same_columns(header, host.nodes, std::vector<BrickLevel>(host.levels.begin(), host.levels.end()),
                              *volume);
        }
  std::cout << packed << " cells packed on the device, " << with_constants << " of them with constant nodes\n";
  EXPECT_GT(with_constants, 0);
}

TEST_F(DevicePack, PrunesAsTheHostDoes) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const kernels::Stream stream(device_);
  kernels::DeviceMemoryStats memory_stats;
  kernels::DeviceHeap heap(stream.handle, memory_stats);
  std::map<NodeKind, std::size_t> nodes_of;
  for (int round = 0; round < 40 && !HasFailure(); ++round) {
    SCOPED_TRACE("round " + std::to_string(round));
    const bool normals = rng() % 3 != 0, directional_coverage = rng() % 3 != 0;
    std::vector<kernels::Level> levels =
        kernels::test::MadeTree(rng, 1 + rng() % 5, normals, directional_coverage).levels();
    kernels::BakedCell cell;
    for (const kernels::Level& level : levels) {
      cell.levels.push_back(on_device(heap, level));
      cell.levels.back().key =
          uploaded<std::uint32_t>(heap, std::vector<std::uint32_t>(level.key.begin(), level.key.end()));
    }
    ASSERT_EQ(cudaStreamSynchronize(heap.stream()), cudaSuccess);
    const NodeTable nodes = kernels::prune(levels, pool_);
    for (const NodeKind kind : nodes.kind) ++nodes_of[kind];
    const ShardHeader header = header_of(normals, directional_coverage, 8u << (levels.size() - 1));
    NodeTable stored = nodes;
    if (!directional_coverage) stored.directional_coverage.clear();
    expect_same_columns(header, stored, std::vector<BrickLevel>(levels.begin(), levels.end()), cell);
  }
  for (const NodeKind kind : {NodeKind::brick, NodeKind::constant, NodeKind::leaf_constant})
    EXPECT_GT(nodes_of[kind], 100u) << int(kind);
}

TEST_F(DevicePack, SaysWhatDoesNotFitItsMemory) {
  kernels::test::TestCell cell = kernels::test::ground("small", 256, 64, false, true);
  const kernels::CellParameters parameters = cell.parameters(SurfaceRule::area, MipFilter::coverage, true);
  const std::unique_ptr<kernels::CudaVolume> volume = baker_->bake(*baker_->upload(cell.input()), parameters);
  kernels::PackRequest request = request_of(header_of(true, true, 256), 6);
  ASSERT_TRUE(packer_->pack(*volume, request));
  request.memory_bytes = 1 << 16;
  EXPECT_THROW(packer_->pack(*volume, request), DeviceFull);
  request.memory_bytes = 0;
  EXPECT_TRUE(packer_->pack(*volume, request));
}

/// Expects two packed columns to have the same bytes.
void expect_equal(const PackedColumn& a, const PackedColumn& b) {
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_TRUE(std::ranges::equal(a.raw, b.raw));
  ASSERT_EQ(a.stored.size(), b.stored.size());
  for (std::size_t c = 0; c < a.stored.size(); ++c) EXPECT_TRUE(std::ranges::equal(a.stored[c], b.stored[c])) << c;
}

TEST_F(DevicePack, MakesTheSameColumnsInLittleMemory) {
  kernels::test::TestCell cell = kernels::test::ground("little memory", 2048, 256, false, true);
  const kernels::CellParameters parameters = cell.parameters(SurfaceRule::area, MipFilter::coverage, true);
  const std::unique_ptr<kernels::CudaVolume> volume = baker_->bake(*baker_->upload(cell.input()), parameters);
  for (const kernels::ColumnBytes as : {kernels::ColumnBytes::stored, kernels::ColumnBytes::raw}) {
    kernels::PackRequest request = request_of(header_of(true, true, 2048), 9);
    request.as = as;
    const auto all = packer_->pack(*volume, request);
    ASSERT_TRUE(all);
    std::uint64_t raw_bytes = 0;
    for (const PackedLevel& level : all->levels) raw_bytes += 10 * level[LevelColumn::rgb].rows;
    int packed = 0;
    for (const std::uint64_t part : {1, 2, 3}) {
      SCOPED_TRACE("1/" + std::to_string(part));
      request.memory_bytes = raw_bytes / part + (std::uint64_t(32) << 20);
      const auto little = packer_->pack(*volume, request);
      ASSERT_TRUE(little);
      ++packed;
      for (std::size_t c = 0; c < all->nodes.size(); ++c) expect_equal(little->nodes[c], all->nodes[c]);
      for (std::size_t lod = 0; lod < all->levels.size(); ++lod)
        for (std::size_t c = 0; c < level_column_count; ++c)
          expect_equal(little->levels[lod].columns[c], all->levels[lod].columns[c]);
    }
    EXPECT_EQ(packed, 3);
  }
}

TEST_F(DevicePack, LeavesToTheHostWhatCameInParts) {
  kernels::test::TestCell ground = kernels::test::ground("parts", 256, 64, false, true);
  kernels::CellParameters parameters = ground.parameters(SurfaceRule::area, MipFilter::coverage, true);
  parameters.memory_bytes = 1;
  const kernels::PackRequest request = request_of(header_of(true, true, parameters.window_voxels), 12);
  EXPECT_FALSE(packer_->pack(*baker_->bake(*baker_->upload(ground.input()), parameters), request));
}

}  // namespace
}  // namespace gigabake
