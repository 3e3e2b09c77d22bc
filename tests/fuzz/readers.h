/// Readers of bytes from other programs, called in the same way as by gigabake. Their input comes from the fuzzers and
/// from the files of tests/fuzz/corpus.
///
/// A reader of several files gets their contents in one array; `part_mark` precedes each file except the first.
/// Errors (all)  InputError or UsageError if the bytes are refused. FaultFound if a reader accepts the bytes but
///               violates its contract. Any other exception is a fault too.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace gigabake::fuzz {

using Bytes = std::span<const std::uint8_t>;

inline constexpr std::string_view part_mark = "\n#%part\n";
std::vector<Bytes> parts_of(Bytes bytes);

struct FaultFound : std::logic_error {
  using std::logic_error::logic_error;
};

// Sources: opened, identified, scanned and read with their images, as in a bake.
void gltf(Bytes bytes);        ///< GLB or glTF; then data.bin
void tile(Bytes bytes);        ///< a b3dm, i3dm or cmpt; its URIs may name model.gltf
void tileset(Bytes bytes);     ///< a tileset.json; its URIs may name model.gltf, nested.json, all.subtree
void subtree(Bytes bytes);     ///< a subtree, binary or JSON, with two contents; then bits.bin
void archive(Bytes bytes);     ///< a .3tz
void scene_json(Bytes bytes);  ///< a scene .json; it may name model.gltf, set.json
void obj(Bytes bytes);         ///< an OBJ; then material.mtl
void ply(Bytes bytes);         ///< a PLY mesh; then one.png
void stl(Bytes bytes);         ///< an STL
void raster(Bytes bytes);      ///< an elevation raster of any format, in EPSG:25832
void orthophoto(Bytes bytes);  ///< a photo of any format over a raster of 17×17
void image(Bytes bytes);       ///< PNG, JPEG, WebP
void geojson(Bytes bytes);     ///< polygons of an area, or the line of a profile

// Results of bakes.
void shard(Bytes bytes);           ///< a shard, read page by page and as a whole
void scene_xml(Bytes bytes);       ///< scene.xml and its parameters
void gigavoxel_list(Bytes bytes);  ///< a .gvp
void gigavoxel_tree(Bytes bytes);  ///< tree.gvx or tree.gvo; then its brick file
void journal(Bytes bytes);
void scan_cache(Bytes bytes);
void bake_status(Bytes bytes);  ///< status.json; it is read, written and read again

// Messages from sockets, and camera paths.
void bake_messages(Bytes bytes);  ///< the first byte selects the decoder
void camera_path(Bytes bytes);    ///< it is read, written and read again
void steering(Bytes bytes);       ///< lines of JSON from a browser, which are applied
void http_head(Bytes bytes);      ///< the value of one header per line

}  // namespace gigabake::fuzz
