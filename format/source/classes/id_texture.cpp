#include "format/source/classes/id_texture.h"

#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/gltf/texture_info.h"
#include "format/source/image/codecs.h"
#include "format/source/image/encoding.h"
#include "format/source/image/image_rows.h"

namespace gigabake {
namespace {

/// Sets the channels; channel 0 is the default of the extension.
void set_channels(const tinygltf::Value& texture, const RefuseIds& refuse, TexelIds& ids) {
  if (!texture.Has("channels")) return;
  const tinygltf::Value& channels = texture.Get("channels");
  const std::size_t count = channels.IsArray() ? channels.ArrayLen() : 0;
  if (count == 0 || count > TexelIds::max_channels)
    refuse(
        fmt::format("texture.channels: expected 1 to {} numbers, so that ids are below 2^24", TexelIds::max_channels));
  ids.channels = std::uint8_t(count);
  for (std::size_t i = 0; i < count; ++i) {
    const tinygltf::Value& channel = channels.Get(i);
    const double number = channel.IsNumber() ? channel.GetNumberAsDouble() : -1;
    if (!(number >= 0 && number <= 3) || number != std::floor(number))
      refuse(fmt::format("texture.channels[{}]: expected a channel from 0 to 3", i));
    ids.channel[i] = std::uint8_t(number);
  }
}

void expect_texture(const tinygltf::Model& model, const tinygltf::Value& texture, const RefuseIds& refuse) {
  const auto index = texture.IsObject() ? whole_number_in(texture, "index") : std::nullopt;
  if (!index || *index >= double(model.textures.size()))
    refuse(fmt::format("texture.index: expected one of the {} textures of the file", model.textures.size()));
  if (texture.Has("texCoord") && !whole_number_in(texture, "texCoord"))
    refuse("texture.texCoord: expected the number of a set of texture coordinates");
}

/// Returns the reader of the texture coordinates.
AccessorItems coordinates_of(const std::filesystem::path& file, const GltfDocument& document,
                             const tinygltf::Primitive& primitive, int set, const RefuseIds& refuse) {
  const std::string name = "TEXCOORD_" + std::to_string(set);
  const auto attribute = primitive.attributes.find(name);
  if (attribute == primitive.attributes.end())
    refuse("has no attribute " + name + ", which its texture of ids requires");
  AccessorItems uv(file, document, attribute->second);
  const std::uint64_t vertices = document.model.accessors[std::size_t(primitive.attributes.at("POSITION"))].count;
  if (uv.components() != 2 || uv.count() != vertices)
    refuse(fmt::format("{}: expected one VEC2 for each of the {} vertices", name, vertices));
  return uv;
}

/// Checks that decoded texels are the ids that were written.
void check_encoding(const EncodedImage& encoded, const RefuseIds& refuse, SourceWarnings& warnings) {
  constexpr std::size_t png_bit_depth_at = 24;
  const Encoding encoding = encoding_of(encoded);
  if (encoding == Encoding::png && encoded.bytes.size() > png_bit_depth_at && encoded.bytes[png_bit_depth_at] > 8)
    refuse(fmt::format("{} has {} bits per channel; expected 8, as in EXT_mesh_features", encoded.name,
                       encoded.bytes[png_bit_depth_at]));
  if (encoding == Encoding::jpeg || (encoding == Encoding::webp && is_lossy_webp(encoded)))
    warnings.count("images of ids with lossy compression, which changes ids", encoded.name);
}

/// Calls visit(row, y) for each row of an image. Holds the whole image only if its format cannot be decoded in rows.
template <class Visit>
void for_each_row(const EncodedImage& encoded, const Visit& visit) {
  if (const auto rows = ImageRows::open(encoded)) {
    std::vector<std::uint8_t> row(4 * rows->size().width);
    for (std::uint64_t y = 0; y < rows->size().height; ++y) {
      rows->next(row.data());
      visit(row.data(), rows->size().width, y);
    }
    return;
  }
  const Image image = decode_image(encoded);
  const auto width = std::size_t(image.width);
  for (std::size_t y = 0; y < std::size_t(image.height); ++y) visit(&image.rgba[4 * width * y], width, y);
}

}  // namespace

IdTextureSource id_texture(const std::filesystem::path& file, const GltfDocument& document,
                           const tinygltf::Primitive& primitive, const tinygltf::Value& texture,
                           const RefuseIds& refuse, SourceWarnings& warnings) {
  expect_texture(document.model, texture, refuse);
  TextureUse use;
  TexelIds ids;
  TextureSource coordinates;
  set_channels(texture, refuse, ids);
  use_texture(document.model, texture_info(texture), use, coordinates, warnings);
  if (use.image >= 0 && coordinates.fault.empty()) coordinates.fault = document.image_faults[std::size_t(use.image)];
  if (!coordinates.fault.empty()) refuse("the image of its ids cannot be used: " + coordinates.fault);
  return {use, ids, coordinates, coordinates_of(file, document, primitive, coordinates.texcoord_set, refuse)};
}

void check_texels(const std::filesystem::path& file, const GltfDocument& document, const IdTextureSource& texture,
                  const RefuseIds& refuse, SourceWarnings& warnings) {
  const auto number = std::size_t(texture.texture.image);
  const std::string key = "images[" + std::to_string(number) + "]";
  const TexelIds& ids = texture.ids;
  std::string fault;  // reported after the last row, because damage is known only then
  const auto check_row = [&](const std::uint8_t* row, std::size_t width, std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::int32_t id = ids.id_of(row + 4 * x);
      if (id == ids.null_id || (id + ids.add >= 0 && id + ids.add <= std::int32_t(max_class))) continue;
      if (fault.empty())
        fault = fmt::format("the id {} + {} of texel ({}, {}) of {} is not a class; expected 0 to {}", id, ids.add, x,
                            y, key, max_class);
    }
  };
  try {
    MemoryClaim(file).add_items(document.images[number].size(), 1, key, "bytes of an image");
    const EncodedImage encoded{key, document.images[number].copy()};
    check_encoding(encoded, refuse, warnings);
    for_each_row(encoded, check_row);
  } catch (const InputError& e) {
    refuse("the image of its ids cannot be used: " + std::string(e.what()));
  }
  if (!fault.empty()) refuse(fault);
}

}  // namespace gigabake
