#include "worker/tiles/tile_store.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <system_error>
#include <utility>

#include "format/source/tile_hash.h"
#include "format/system/io_error.h"
#include "lattice/error.h"
#include "worker/tiles/tile_file.h"
#include "worker/tiles/tile_gatherer.h"

namespace gigabake {
namespace {

/// Held until it goes out of scope; a process that dies lets go of it. Others wait.
class TurnAt {
 public:
  explicit TurnAt(const std::filesystem::path& file) : file_(file, O_RDWR | O_CREAT) {
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    while (file_.is_open() && ::fcntl(file_.get(), F_OFD_SETLKW, &whole) != 0 && errno == EINTR) {
    }
    // Without a lock two ranks may do the same work, and each publishes a whole file.
  }

 private:
  Descriptor file_;
};

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(folder, "", "cannot make the scratch folder: " + error.message());
}

}  // namespace

TileScratch scratch_in(std::filesystem::path folder, std::uint64_t memory_bytes) {
  return {std::move(folder), memory_bytes == 0 ? std::numeric_limits<std::uint64_t>::max() : memory_bytes / 16};
}

TileStore::TileStore(const SceneSources& sources, const BakeParameters& parameters, TileScratch scratch, int threads)
    : sources_(sources), parameters_(parameters), scratch_(std::move(scratch)), pool_(threads) {}

bool TileStore::may_be_large(std::uint32_t tile) const {
  return !scratch_.folder.empty() && sources_.tiles.at(tile).bytes > scratch_.most_tile_bytes;
}

std::shared_ptr<const LoadedTile> TileStore::load(std::uint32_t tile, const std::optional<Hash128>& expected) const {
  if (scratch_.folder.empty() || !expected) return read(tile, expected, {});
  const std::filesystem::path file = scratch_.folder / ("t_" + expected->hex() + ".clusters");
  if (auto found = stored(file)) return found;
  if (!may_be_large(tile)) return read(tile, expected, file);
  make_folder(scratch_.folder);
  const TurnAt turn(std::filesystem::path(file) += ".lock");
  if (auto found = stored(file)) return found;
  return read(tile, expected, file);
}

std::shared_ptr<const LoadedTile> TileStore::stored(const std::filesystem::path& file) const {
  std::shared_ptr<const TileFile> clusters = TileFile::open(file);
  if (clusters == nullptr) return nullptr;
  TileDirectory directory = directory_from_bytes(clusters->directory());
  return std::make_shared<const LoadedTile>(std::move(directory), std::move(clusters), parameters_, pool_);
}

std::shared_ptr<const LoadedTile> TileStore::read(std::uint32_t tile, const std::optional<Hash128>& expected,
                                                  const std::filesystem::path& file) const {
  const TileRef& ref = sources_.tiles.at(tile);
  TileGatherer gatherer(ref.path, {scratch_.most_tile_bytes, file}, pool_);
  TileMesh mesh = read_tile(ref, sources_.root, ReadScope::everything,
                            [&](std::size_t, Primitive&& primitive) { gatherer.take(std::move(primitive)); });
  // Compared after it was read: a file that is replaced meanwhile is caught too.
  if (expected && tile_hash(ref, sources_.root) != *expected)
    throw InputError(ref.path, "", "changed while the bake ran; bake again");
  TileDirectory directory = gatherer.finish(std::move(mesh));
  if (!gatherer.is_on_scratch())
    return std::make_shared<const LoadedTile>(std::move(directory), nullptr, parameters_, pool_);
  std::shared_ptr<const TileFile> clusters = TileFile::open(file);
  if (clusters == nullptr)
    throw IoError(file, "", "is not there, though it was just written; is another bake clearing the folder?");
  return std::make_shared<const LoadedTile>(std::move(directory), std::move(clusters), parameters_, pool_);
}

}  // namespace gigabake
