#include "worker/scan/survey_tile.h"

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

TileMesh add_held(const TileRef& tile, const std::filesystem::path& root, TileScanner& surveyor) {
  TileMesh mesh = read_tile(tile, root, ReadScope::positions_only);
  const auto placed = placements_of(mesh);
  for (std::size_t p = 0; p < placed.size(); ++p) surveyor.add(mesh.primitives[p], placed[p]);
  return mesh;
}

TileMesh add_stored(const LoadedTile& tile, TileScanner& surveyor) {
  const auto placed = placements_of(tile.mesh());
  for (std::size_t p = 0; p < placed.size(); ++p) surveyor.add(tile, p, placed[p]);
  return tile.mesh();
}

/// Scans the tile without holding the whole mesh in memory. Reads the file twice, because a part is read before its
/// placements are known.
TileMesh add_in_parts(const TileRef& tile, const std::filesystem::path& root, TileScanner& surveyor) {
  TileMesh mesh = read_tile(tile, root, ReadScope::positions_only, [](std::size_t, const Primitive&) {});
  const auto placed = placements_of(mesh);
  read_tile(tile, root, ReadScope::positions_only, [&](std::size_t p, const Primitive& part) {
    if (p >= placed.size()) throw InputError(tile.path, "", "changed while it was read");
    surveyor.add(part, placed[p]);
  });
  return mesh;
}

void take_counts(const TileMesh& mesh, TileScan& survey) {
  survey.triangles = mesh.counts.triangles;
  survey.skipped_points = mesh.counts.skipped_points;
  survey.skipped_lines = mesh.counts.skipped_lines;
  survey.warnings = mesh.warnings;
}

TileScan unreadable(std::uint32_t tile, std::string reason) {
  TileScan survey;
  survey.tile = tile;
  survey.error = std::move(reason);
  return survey;
}

}  // namespace

TileScan survey_tile(const SceneSources& sources, std::uint32_t tile, const BakeParameters& parameters,
                     const ThreadPool& pool, const TileStore* store) {
  TileScan survey;
  survey.tile = tile;
  const TileRef& ref = sources.tiles.at(tile);
  try {
    // The identity is taken first, because the files' stamps must be older than everything that is read from the files.
    TileIdentity identity = identify_tile(ref, sources.root);
    TileScanner surveyor(ref, parameters, pool);
    if (store == nullptr || !store->may_be_large(tile))
      take_counts(add_held(ref, sources.root, surveyor), survey);
    else if (store->has_scratch())
      take_counts(add_stored(*store->load(tile, identity.hash), surveyor), survey);
    else
      take_counts(add_in_parts(ref, sources.root, surveyor), survey);
    surveyor.finish(survey);
    survey.source = identity.hash;
    survey.files = std::move(identity.files);
    return survey;
  } catch (const std::bad_alloc&) {
    return unreadable(tile, InputError(ref.path, "", not_enough_memory).what());
  } catch (const std::exception& e) {
    return unreadable(tile, e.what());
  }
}

}  // namespace gigabake
