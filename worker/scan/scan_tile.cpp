#include "worker/scan/scan_tile.h"

#include <new>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "format/source/tile_hash.h"
#include "worker/scan/tile_scanner.h"

namespace gigabake {
namespace {

/// Returns the placements of each primitive. The mesh must outlive the result.
std::vector<std::vector<const Instance*>> placements_of(const TileMesh& mesh) {
  std::vector<std::vector<const Instance*>> placed(mesh.primitives.size());
  for (const Instance& instance : mesh.instances) placed[std::size_t(instance.primitive)].push_back(&instance);
  return placed;
}

TileMesh add_held(const TileRef& tile, const std::filesystem::path& root, TileScanner& scanner) {
  TileMesh mesh = read_tile(tile, root, ReadScope::positions_only);
  const auto placed = placements_of(mesh);
  for (std::size_t p = 0; p < placed.size(); ++p) scanner.add(mesh.primitives[p], placed[p]);
  return mesh;
}

TileMesh add_stored(const LoadedTile& tile, TileScanner& scanner) {
  const auto placed = placements_of(tile.mesh());
  for (std::size_t p = 0; p < placed.size(); ++p) scanner.add(tile, p, placed[p]);
  return tile.mesh();
}

/// Scans the tile without holding the whole mesh in memory. Reads the file twice, because a part is read before its
/// placements are known.
TileMesh add_in_parts(const TileRef& tile, const std::filesystem::path& root, const ThreadPool& pool,
                      TileScanner& scanner) {
  TileMesh mesh = read_tile(
      tile, root, ReadScope::positions_only, [](std::size_t, const Primitive&) {}, pool);
  const auto placed = placements_of(mesh);
  read_tile(
      tile, root, ReadScope::positions_only,
      [&](std::size_t p, const Primitive& part) {
        if (p >= placed.size()) throw InputError(tile.path, "", "changed while it was read");
        scanner.add(part, placed[p]);
      },
      pool);
  return mesh;
}

void take_counts(const TileMesh& mesh, TileScan& scan) {
  scan.triangles = mesh.counts.triangles;
  scan.skipped_points = mesh.counts.skipped_points;
  scan.skipped_lines = mesh.counts.skipped_lines;
  scan.warnings = mesh.warnings;
  scan.classified = mesh.classified;
  scan.sized = mesh.sized;
}

TileScan unreadable(std::uint32_t tile, std::string reason) {
  TileScan scan;
  scan.tile = tile;
  scan.error = std::move(reason);
  return scan;
}

}  // namespace

TileScan scan_tile(const SceneSources& sources, std::uint32_t tile, const BakeParameters& parameters,
                   const ThreadPool& pool, const TileStore* store) {
  TileScan scan;
  scan.tile = tile;
  const TileRef& ref = sources.tiles.at(tile);
  try {
    // The identity is taken first, because the files' stamps must be older than everything that is read from the files.
    TileIdentity identity = identify_tile(ref, sources.root);
    TileScanner scanner(ref, parameters, pool);
    if (store == nullptr || !store->may_be_large(tile))
      take_counts(add_held(ref, sources.root, scanner), scan);
    else if (store->has_scratch())
      take_counts(add_stored(*store->load(tile, identity.hash, identity.files), scanner), scan);
    else
      take_counts(add_in_parts(ref, sources.root, pool, scanner), scan);
    scanner.finish(scan);
    scan.source = identity.hash;
    scan.files = std::move(identity.files);
    return scan;
  } catch (const std::bad_alloc&) {
    return unreadable(tile, InputError(ref.path, "", not_enough_memory).what());
  } catch (const UsageError& e) {
    scan = unreadable(tile, e.what());
    scan.is_refused = true;
    return scan;
  } catch (const std::exception& e) {
    return unreadable(tile, e.what());
  }
}

}  // namespace gigabake
