#include "worker/tiles/tile_directory.h"

#include <utility>

#include "core/base/error.h"
#include "core/io/bytes.h"
#include "core/octree/texel_ids.h"
#include "format/source/image/image_size.h"
#include "format/source/source_warning.h"
#include "format/system/hash_bytes.h"

namespace gigabake {
namespace {

constexpr const char* directory_name = "directory of a scratch file";

void put_stored(ByteWriter& w, const ScratchBytes& stored) {
  w.put(stored.offset), w.put(stored.checksum), w.put(stored.bytes);
}

ScratchBytes get_stored(ByteReader& r) {
  ScratchBytes stored;
  r.get(stored.offset), r.get(stored.checksum), r.get(stored.bytes);
  return stored;
}

void put_image(ByteWriter& w, const TileImage& image) {
  w.put(image.hash), w.put(image.texture_bytes), w.put(image.encoded.name);
  put_stored(w, image.stored);
}

TileImage get_image(ByteReader& r) {
  TileImage image;
  r.get(image.hash), r.get(image.texture_bytes), r.get(image.encoded.name);
  image.stored = get_stored(r);
  return image;
}

void put_texture(ByteWriter& w, const TextureUse& t) {
  w.put(t.image), w.put(t.wrap_s), w.put(t.wrap_t), w.put(t.nearest);
}

void put_material(ByteWriter& w, const Material& m) {
  w.put(m.base_color);
  put_texture(w, m.texture), put_texture(w, m.normal_map.texture);
  w.put(m.normal_map.scale), w.put(m.alpha_mode), w.put(m.alpha_cutoff), w.put(m.double_sided), w.put(m.unlit);
  w.put(m.voxel_class);
}

/// Reads an enum that is stored as a number, with values 0 to `last`.
template <class Enum>
void get_numbered(ByteReader& r, Enum& value, Enum last) {
  std::uint8_t number = 0;
  r.get(number);
  if (number > std::uint8_t(last))
    throw InputError(directory_name, "", "holds " + std::to_string(number) + ", which is not a valid value");
  value = Enum(number);
}

void get_texture(ByteReader& r, TextureUse& t) {
  r.get(t.image);
  get_numbered(r, t.wrap_s, Wrap::clamp_to_edge), get_numbered(r, t.wrap_t, Wrap::clamp_to_edge);
  r.get(t.nearest);
}

Material get_material(ByteReader& r) {
  Material m;
  r.get(m.base_color);
  get_texture(r, m.texture), get_texture(r, m.normal_map.texture);
  r.get(m.normal_map.scale);
  get_numbered(r, m.alpha_mode, AlphaMode::blend);
  r.get(m.alpha_cutoff), r.get(m.double_sided), r.get(m.unlit), r.get(m.voxel_class);
  return m;
}

/// Writes the number of items, then each item with `put`.
template <class T, class Put>
void put_list(ByteWriter& w, const std::vector<T>& items, const Put& put) {
  w.put(std::uint64_t(items.size()));
  for (const T& item : items) put(w, item);
}

template <class T, class Get>
void get_list(ByteReader& r, std::vector<T>& items, const Get& get) {
  std::uint64_t count = 0;
  r.get(count);
  for (std::uint64_t i = 0; i < count; ++i) items.push_back(get(r));  // get() throws at the end of the bytes
}

void put_cluster(ByteWriter& w, const TileCluster& c) {
  w.put(c.bounds);
  put_stored(w, c.stored);
}

TileCluster get_cluster(ByteReader& r) {
  TileCluster c;
  r.get(c.bounds);
  c.stored = get_stored(r);
  return c;
}

void put_primitive(ByteWriter& w, const TilePrimitive& p) {
  w.put(p.bounds), w.put(p.triangles);
  put_list(w, p.clusters, put_cluster);
}

TilePrimitive get_primitive(ByteReader& r) {
  TilePrimitive p;
  r.get(p.bounds), r.get(p.triangles);
  get_list(r, p.clusters, get_cluster);
  return p;
}

void put_warning(ByteWriter& w, const SourceWarning& warning) {
  each_field_of_warning(warning, [&w](const auto& field) { w.put(field); });
}

SourceWarning get_warning(ByteReader& r) {
  SourceWarning warning;
  each_field_of_warning(warning, [&r](auto& field) { r.get(field); });
  return warning;
}

void put_shell(ByteWriter& w, const Primitive& p) {
  w.put(std::int32_t(p.material)), w.put(p.position_step), w.put(p.shares_uv), w.put(p.voxel_class);
  put_texture(w, p.id_texture.texture), w.put(p.id_texture.ids ? *p.id_texture.ids : TexelIds());
}

Primitive get_shell(ByteReader& r) {
  Primitive p;
  std::int32_t material = 0;
  r.get(material), r.get(p.position_step), r.get(p.shares_uv), r.get(p.voxel_class);
  TexelIds ids;
  get_texture(r, p.id_texture.texture), r.get(ids);
  if (p.id_texture.texture.image >= 0) p.id_texture.ids = std::make_shared<const TexelIds>(ids);
  p.material = material;
  return p;
}

void put_instance(ByteWriter& w, const Instance& i) {
  w.put(std::int32_t(i.primitive)), w.put(i.scene_from_local), w.put(i.lod), w.put(i.voxel_class);
}

Instance get_instance(ByteReader& r) {
  Instance i;
  std::int32_t primitive = 0;
  r.get(primitive), r.get(i.scene_from_local), r.get(i.lod), r.get(i.voxel_class);
  i.primitive = primitive;
  return i;
}

void check(const TileDirectory& d) {
  const auto within = [](int index, std::size_t size) { return index >= 0 && std::size_t(index) < size; };
  bool is_right = d.primitives.size() == d.mesh.primitives.size();
  const auto is_level = [](std::int32_t lod) { return lod >= not_stated && lod <= max_source_lod; };
  const auto is_class = [](std::int32_t c) { return c >= not_stated && c <= std::int32_t(max_class); };
  for (const Instance& i : d.mesh.instances)
    is_right = is_right && within(i.primitive, d.primitives.size()) && is_level(i.lod) && is_class(i.voxel_class);
  const auto is_right_texture = [&](const IdTexture& t) {
    if (!t.ids) return true;
    bool are_channels = t.ids->channels >= 1 && t.ids->channels <= TexelIds::max_channels;
    for (const std::uint8_t channel : t.ids->channel) are_channels = are_channels && channel < 4;
    return are_channels && within(t.texture.image, d.images.size());
  };
  for (const Primitive& p : d.mesh.primitives)
    is_right = is_right && within(p.material, d.mesh.materials.size()) && is_class(p.voxel_class) &&
               is_right_texture(p.id_texture);
  for (const Material& m : d.mesh.materials) is_right = is_right && is_class(m.voxel_class);
  for (const Material& m : d.mesh.materials)
    for (const int image : {m.texture.image, m.normal_map.texture.image})
      is_right = is_right && (image < 0 || within(image, d.images.size()));
  if (!is_right) throw InputError(directory_name, "", "refers to missing items");
}

}  // namespace

TileImage tile_image(EncodedImage&& encoded) {
  const Hash128 hash = hash_of_bytes(encoded.bytes);
  TileImage image{hash, 0, std::move(encoded)};
  try {
    if (!image.encoded.bytes.empty()) image.texture_bytes = image_size(image.encoded).texture_bytes();
  } catch (const InputError&) {
    // The decoder reports the error, because a damaged image is accepted if nothing uses it.
  }
  return image;
}

std::vector<std::uint8_t> to_bytes(const TileDirectory& d) {
  ByteWriter w;
  put_list(w, d.mesh.primitives, put_shell), put_list(w, d.mesh.instances, put_instance);
  put_list(w, d.mesh.materials, put_material), put_list(w, d.images, put_image);
  w.put(d.mesh.counts);
  put_list(w, d.mesh.warnings, put_warning);
  w.put(d.mesh.classified), w.put(d.mesh.sized);
  put_list(w, d.primitives, put_primitive);
  return w.take();
}

TileDirectory directory_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, directory_name);
  TileDirectory d;
  get_list(r, d.mesh.primitives, get_shell), get_list(r, d.mesh.instances, get_instance);
  get_list(r, d.mesh.materials, get_material), get_list(r, d.images, get_image);
  r.get(d.mesh.counts);
  get_list(r, d.mesh.warnings, get_warning);
  r.get(d.mesh.classified), r.get(d.mesh.sized);
  get_list(r, d.primitives, get_primitive);
  r.expect_end();
  check(d);
  return d;
}

}  // namespace gigabake
