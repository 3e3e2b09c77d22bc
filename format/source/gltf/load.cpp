#include "format/source/gltf/load.h"

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/content/data_uri.h"
#include "format/source/gltf/check.h"
#include "format/source/gltf/draco_primitive.h"
#include "format/source/gltf/model/model.h"
#include "format/source/gltf/packed_views.h"
#include "format/source/image/image_check.h"
#include "format/source/loss_reason.h"

namespace gigabake {
namespace {

bool is_in_view(const Json& image) { return image.contains("bufferView") && image["bufferView"].is_number(); }

/// Claims memory for the model: a pair of braces in the document becomes hundreds of bytes of the model.
void claim_model(const std::filesystem::path& file, const Json& gltf) {
  MemoryClaim memory(file);
  const auto claim = [&](const char* list, std::uint64_t bytes) {
    memory.add_items(get_array(file, gltf, "", list).size(), bytes, list, "of them");
  };
  claim("nodes", sizeof(tinygltf::Node)), claim("meshes", sizeof(tinygltf::Mesh));
  claim("materials", sizeof(tinygltf::Material)), claim("accessors", sizeof(tinygltf::Accessor));
  claim("bufferViews", sizeof(tinygltf::BufferView)), claim("textures", sizeof(tinygltf::Texture));
  claim("images", sizeof(tinygltf::Image)), claim("samplers", sizeof(tinygltf::Sampler));
  claim("scenes", sizeof(tinygltf::Scene)), claim("animations", sizeof(tinygltf::Animation));
  claim("skins", sizeof(tinygltf::Skin));
  for (const Json& mesh : get_array(file, gltf, "", "meshes"))
    memory.add_items(get_array(file, mesh, "meshes", "primitives").size(), sizeof(tinygltf::Primitive), "meshes",
                     "primitives");
}

/// Returns RTC_CENTER of the container plus the centre of the extension CESIUM_RTC.
std::array<double, 3> rtc_center_of(const std::filesystem::path& file, const Json& gltf,
                                    const ContentContainer& container) {
  std::array<double, 3> out = container.rtc_center;
  const Json& rtc = get_object(file, get_object(file, gltf, "", "extensions"), "extensions", "CESIUM_RTC");
  if (const auto center = get_numbers(file, rtc, "extensions.CESIUM_RTC", "center", 3))
    for (std::size_t c = 0; c < 3; ++c) out[c] += (*center)[c];
  return out;
}

void load_buffers(const SourceFiles& files, const std::filesystem::path& file, const Json& gltf, const SourceBytes& bin,
                  GltfDocument& out) {
  const Json& buffers = get_array(file, gltf, "", "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string where = "buffers[" + std::to_string(i) + "]";
    const std::uint64_t bytes = get_index(file, buffers[i], where, "byteLength").value_or(0);
    const auto uri = get_text(file, buffers[i], where, "uri");
    SourceBytes there;
    if (uri)
      there = SourceBytes(uri_bytes(files, file, where + ".uri", *uri));
    else if (i == 0)
      there = bin;
    if (there.size() < bytes && !is_absent_fallback(file, buffers[i], i, !bin.empty()))
      throw InputError(file, where, "holds fewer bytes than its byteLength");
    out.buffers.push_back(there);
  }
}

/// Returns an image's encoded bytes.
/// Errors  InputError: the image has no bytes, or they cannot be read.
SourceBytes image_bytes(const SourceFiles& files, const std::filesystem::path& file, const Json& image,
                        const std::string& where, const GltfDocument& document) {
  if (is_in_view(image)) return document.view_bytes(image["bufferView"].get<int>());
  const auto uri = get_text(file, image, where, "uri");
  if (!uri) throw InputError(file, where, "has neither a uri nor a bufferView");
  return SourceBytes(uri_bytes(files, file, where + ".uri", *uri));
}

void load_images(const SourceFiles& files, const std::filesystem::path& file, const Json& gltf, bool with_images,
                 GltfDocument& out) {
  const Json& images = get_array(file, gltf, "", "images");
  out.images.resize(images.size());
  out.image_faults.resize(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const std::string where = "images[" + std::to_string(i) + "]";
    try {
      const SourceBytes bytes = image_bytes(files, file, images[i], where, out);
      check_image(file, where, bytes);
      if (with_images) out.images[i] = bytes;
    } catch (const InputError& e) {
      out.image_faults[i] = reason_without_place(e.what(), file, "");
    }
  }
}

}  // namespace

SourceBytes GltfDocument::view_bytes(int view) const {
  const tinygltf::BufferView& v = model.bufferViews[std::size_t(view)];
  return buffers[std::size_t(v.buffer)].part(v.byteOffset, v.byteLength);
}

int GltfDocument::add_buffer(std::vector<std::uint8_t> bytes) {
  buffers.emplace_back(std::move(bytes));
  return int(buffers.size()) - 1;
}

GltfDocument load_gltf(const TileRef& tile, const std::filesystem::path& root, bool with_images) {
  GltfDocument out;
  const SourceFiles files = files_of(tile, root);
  ContentContainer container = open_container(tile, files);
  const std::filesystem::path& file = container.gltf_file;
  const Json json = parse_json(file, container.json.span());
  container.json = container.gltf = container.content = SourceBytes();  // frees the text, which may have all buffers
  check_gltf(files, file, json, container.bin.size());
  const std::vector<PackedView> packed = packed_views(file, json, !container.bin.empty());
  out.rtc_center = rtc_center_of(file, json, container);
  out.instances = std::move(container.instances);
  out.instance_ids = std::move(container.instance_ids);
  out.is_instanced = container.is_instanced;
  out.has_unused_instance_ids = container.has_unused_instance_ids;
  claim_model(file, json);
  out.model = model_of(json);
  refer_to_packed_bytes(packed, out.model);
  load_buffers(files, file, json, container.bin, out);
  load_images(files, file, json, with_images, out);
  unpack_views(file, packed, out);
  unpack_draco(file, out);
  return out;
}

}  // namespace gigabake
