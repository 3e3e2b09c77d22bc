#include "format/source/gltf/load.h"

#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/quote.h"
#include "format/source/content/data_uri.h"
#include "format/source/gltf/check.h"
#include "format/source/gltf/draco_primitive.h"
#include "format/source/gltf/packed_views.h"
#include "format/source/image/image_check.h"
#include "format/source/loss_reason.h"

namespace gigabake {
namespace {

constexpr int no_index = std::numeric_limits<int>::max();  ///< in place of a number that names nothing

bool keep_nothing(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return true;
}

bool file_exists(const std::string&, void*) { return false; }

std::string same_path(const std::string& path, void*) { return path; }

bool read_no_file(std::vector<unsigned char>*, std::string*, const std::string&, void*) { return false; }

/// Returns tinygltf's first error. tinygltf quotes whole data URIs, and file names without quotation marks.
std::string first_line(const std::string& text) {
  constexpr std::size_t max_bytes = 200;
  const auto begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return "cannot be read as glTF";
  return short_text(std::string_view(text).substr(begin, text.find_first_of("\r\n", begin) - begin), max_bytes);
}

/// Parses a document without payloads: tinygltf reads no file, decodes no image and copies no buffer.
void parse(const std::filesystem::path& file, const std::string& text, GltfDocument& out) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_nothing, nullptr);
  loader.SetFsCallbacks({file_exists, same_path, read_no_file, nullptr, nullptr});
  std::string error, warning;
  if (!loader.LoadASCIIFromString(&out.model, &error, &warning, text.data(), unsigned(text.size()), "."))
    throw InputError(file, "", first_line(error));
}

bool is_in_view(const Json& image) { return image.contains("bufferView") && image["bufferView"].is_number(); }

/// Replaces the bytes of each buffer and image by one byte, because tinygltf is unsuited to read them. It supports few
/// media types of data URIs, expands paths by the shell's rules, and reads images from a copy of the binary chunk.
void hide_payloads(Json& gltf) {
  constexpr const char* byte_of_buffer = "data:application/octet-stream;base64,AA==";
  constexpr const char* byte_of_image = "data:image/png;base64,AA==";
  if (gltf.contains("buffers"))
    for (Json& buffer : gltf["buffers"]) buffer = {{"byteLength", 1u}, {"uri", byte_of_buffer}};
  if (gltf.contains("images"))
    for (Json& image : gltf["images"]) image = {{"uri", byte_of_image}};
}

/// Makes a member an int: 3.0 becomes 3, and any other value becomes an index that names nothing.
void fit_int(Json& object, const char* key) {
  const auto at = object.find(key);
  if (at == object.end()) return;
  const double value = at->is_number() ? at->get<double>() : -1;
  const bool fits = value >= 0 && value < no_index && value == std::floor(value);
  *at = fits ? int(value) : no_index;
}

/// Prepares a material's use of a texture. A use without an index names no texture.
void fit_texture_use(Json& owner, const char* key) {
  if (!owner.contains(key) || !owner[key].is_object()) return;
  if (!owner[key].contains("index")) owner[key]["index"] = no_index;
  fit_int(owner[key], "index");
}

/// Prepares textures and samplers, so that one that cannot be used costs one image: tinygltf would wrap or refuse such
/// numbers.
void fit_textures(Json& gltf) {
  if (gltf.contains("textures"))
    for (Json& texture : gltf["textures"]) fit_int(texture, "source"), fit_int(texture, "sampler");
  if (gltf.contains("samplers"))
    for (Json& sampler : gltf["samplers"])
      for (const char* key : {"magFilter", "minFilter", "wrapS", "wrapT"}) fit_int(sampler, key);
  if (!gltf.contains("materials")) return;
  for (Json& material : gltf["materials"]) {
    for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"}) fit_texture_use(material, key);
    for (const char* key : {"baseColorTexture", "metallicRoughnessTexture"})
      if (material.contains("pbrMetallicRoughness")) fit_texture_use(material["pbrMetallicRoughness"], key);
    const Json::json_pointer gloss("/extensions/KHR_materials_pbrSpecularGlossiness");
    if (material.contains(gloss)) fit_texture_use(material[gloss], "diffuseTexture");
  }
}

/// Claims memory for the model: a pair of braces in the document becomes hundreds of bytes of the model.
void claim_model(const std::filesystem::path& file, const Json& gltf) {
  constexpr std::uint64_t growth = 2;  // of lists, by doubling
  MemoryClaim memory(file);
  const auto claim = [&](const char* list, std::uint64_t bytes) {
    memory.add_items(get_array(file, gltf, "", list).size(), growth * bytes, list, "of them");
  };
  claim("nodes", sizeof(tinygltf::Node)), claim("meshes", sizeof(tinygltf::Mesh));
  claim("materials", sizeof(tinygltf::Material)), claim("accessors", sizeof(tinygltf::Accessor));
  claim("bufferViews", sizeof(tinygltf::BufferView)), claim("buffers", sizeof(tinygltf::Buffer));
  claim("textures", sizeof(tinygltf::Texture)), claim("images", sizeof(tinygltf::Image));
  claim("samplers", sizeof(tinygltf::Sampler)), claim("scenes", sizeof(tinygltf::Scene));
  claim("animations", sizeof(tinygltf::Animation)), claim("skins", sizeof(tinygltf::Skin));
  claim("cameras", sizeof(tinygltf::Camera));
  for (const Json& mesh : get_array(file, gltf, "", "meshes"))
    memory.add_items(get_array(file, mesh, "meshes", "primitives").size(), growth * sizeof(tinygltf::Primitive),
                     "meshes", "primitives");
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
  check_gltf(files, file, json, container.bin.size());
  const std::vector<PackedView> packed = packed_views(file, json, !container.bin.empty());
  Json plain = without_packed_views(json, packed);
  hide_packed_indices(plain);
  hide_payloads(plain);
  fit_textures(plain);
  out.rtc_center = container.rtc_center;
  out.instances = std::move(container.instances);
  const Json& extensions = get_object(file, json, "", "extensions");
  const Json& rtc = get_object(file, extensions, "extensions", "CESIUM_RTC");
  if (const auto center = get_numbers(file, rtc, "extensions.CESIUM_RTC", "center", 3))
    for (std::size_t c = 0; c < 3; ++c) out.rtc_center[c] += (*center)[c];
  claim_model(file, plain);
  parse(file, plain.dump(), out);
  out.model.buffers.clear();
  load_buffers(files, file, json, container.bin, out);
  load_images(files, file, json, with_images, out);
  unpack_views(file, packed, out);
  unpack_draco(file, json, out);
  return out;
}

}  // namespace gigabake
