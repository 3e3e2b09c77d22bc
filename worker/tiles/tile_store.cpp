#include "worker/tiles/tile_store.h"

#include <limits>
#include <utility>

#include "core/base/error.h"
#include "format/source/tile_hash.h"
#include "worker/tiles/scratch_publication.h"
#include "worker/tiles/tile_file.h"
#include "worker/tiles/tile_gatherer.h"

namespace gigabake {

TileScratch scratch_in(std::filesystem::path folder, std::uint64_t memory_bytes) {
  return {std::move(folder), memory_bytes == 0 ? std::numeric_limits<std::uint64_t>::max() : memory_bytes / 128};
}

TileStore::TileStore(const SceneSources& sources, const BakeParameters& parameters, TileScratch scratch, int threads)
    : sources_(sources), parameters_(parameters), scratch_(std::move(scratch)), pool_(threads) {}

bool TileStore::may_be_large(std::uint32_t tile) const {
  return sources_.tiles.at(tile).bytes > scratch_.max_tile_bytes;
}

std::shared_ptr<const LoadedTile> TileStore::load(std::uint32_t tile, const std::optional<Hash128>& expected,
                                                  std::span<const StampedFile> hashed) const {
  if (scratch_.folder.empty() || !expected) return read(tile, expected, hashed, {});
  const std::string content = parameters_.normals ? "" : "_without_normals";
  const std::filesystem::path file = scratch_.folder / ("t_" + expected->hex() + content + ".clusters");
  const auto find = [&] { return stored(file); };
  const auto make = [&] { return read(tile, expected, hashed, file); };
  if (may_be_large(tile)) return find_or_make(file, find, make);
  const auto found = find();  // a small file, but its decompressed triangles may exceed the limit
  return found ? found : make();
}

std::shared_ptr<const LoadedTile> TileStore::stored(const std::filesystem::path& file) const {
  std::shared_ptr<const TileFile> clusters = TileFile::open(file);
  if (clusters == nullptr) return nullptr;
  TileDirectory directory = directory_from_bytes(clusters->directory());
  return std::make_shared<const LoadedTile>(std::move(directory), std::move(clusters), parameters_, pool_);
}

std::shared_ptr<const LoadedTile> TileStore::read(std::uint32_t tile, const std::optional<Hash128>& expected,
                                                  std::span<const StampedFile> hashed,
                                                  const std::filesystem::path& file) const {
  const TileRef& ref = sources_.tiles.at(tile);
  TilePrimitiveCollector gatherer(ref.path, {scratch_.max_tile_bytes, file}, pool_);
  const ReadScope scope = parameters_.normals ? ReadScope::everything : ReadScope::without_normals;
  TileMesh mesh = read_tile(
      ref, sources_.root, scope, [&](std::size_t, Primitive&& primitive) { gatherer.take(std::move(primitive)); },
      pool_);
  // The files are compared after the read, so that a replacement of a file during the read is detected too.
  if (expected && !are_unchanged(ref, hashed) && tile_hash(ref, sources_.root) != *expected)
    throw InputError(ref.path, "", "changed while the bake ran; bake again");
  TileDirectory directory = gatherer.finish(std::move(mesh));
  if (!gatherer.is_on_scratch())
    return std::make_shared<const LoadedTile>(std::move(directory), nullptr, parameters_, pool_);
  std::shared_ptr<const TileFile> clusters = TileFile::open(file);
  if (clusters == nullptr)
    throw IoError(file, "", "is missing, although it was just written; does another bake clear the folder?");
  return std::make_shared<const LoadedTile>(std::move(directory), std::move(clusters), parameters_, pool_);
}

}  // namespace gigabake
