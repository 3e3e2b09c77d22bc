#include "format/source/gltf/load.h"

#include "format/source/gltf/check.h"
#include "format/source/gltf/draco_primitive.h"
#include "format/source/gltf/packed_views.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"

namespace gigabake {
namespace {

/// What the callbacks need. tinygltf expands paths with the shell's rules and reads any file; ours do not.
struct LoadContext {
  const SourceFiles& files;
  const std::filesystem::path& file;
  bool with_images;
  GltfDocument& out;
};

bool keep_encoded(tinygltf::Image*, const int index, std::string*, std::string*, int, int, const unsigned char* bytes,
                  int size, void* user) {
  auto& context = *static_cast<LoadContext*>(user);
  if (index < 0 || std::size_t(index) >= context.out.images.size()) return true;
  context.out.has_image[std::size_t(index)] = size > 0;
  if (context.with_images)
    context.out.images[std::size_t(index)] = SourceBytes(std::vector<std::uint8_t>(bytes, bytes + size));
  return true;
}

bool file_exists(const std::string& path, void* user) { return static_cast<LoadContext*>(user)->files.has(path); }

std::string same_path(const std::string& path, void*) { return path; }

/// tinygltf has joined and percent-decoded the path by now; whatever it made of it must lie inside the root.
bool read_inside_root(std::vector<unsigned char>* out, std::string* error, const std::string& path, void* user) {
  const auto& context = *static_cast<LoadContext*>(user);
  try {
    const std::filesystem::path root = std::filesystem::weakly_canonical(context.files.root());
    const std::filesystem::path target = std::filesystem::weakly_canonical(path);
    if (std::mismatch(root.begin(), root.end(), target.begin(), target.end()).first != root.end())
      throw InputError(path, "", "leaves the source folder");
    *out = context.files.read_referenced(target);
    return true;
  } catch (const std::exception& e) {
    if (error != nullptr) *error += e.what();
    return false;
  }
}

/// tinygltf quotes whole data URIs.
std::string first_line(const std::string& text) {
  constexpr std::size_t longest = 200;
  const auto begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return "cannot be read as glTF";
  const std::string line = text.substr(begin, text.find_first_of("\r\n", begin) - begin);
  return line.size() <= longest ? line : line.substr(0, longest) + "…";
}

/// Every document is given as text: no buffer of a GLB is tinygltf's to copy.
void parse(std::span<const std::uint8_t> text, LoadContext& context) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, &context);
  loader.SetFsCallbacks({file_exists, same_path, read_inside_root, nullptr, &context});
  std::string error, warning;
  const std::string base = context.file.has_parent_path() ? context.file.parent_path().string() : ".";
  if (!loader.LoadASCIIFromString(&context.out.model, &error, &warning, reinterpret_cast<const char*>(text.data()),
                                  unsigned(text.size()), base))
    throw InputError(context.file, "", first_line(error));
}

bool is_in_view(const Json& image) { return image.contains("bufferView") && image["bufferView"].is_number(); }

/// Puts a byte of its own in place of each buffer without a URI, and of each image in a view: tinygltf would look for
/// them in a copy of the binary chunk. Returns whether there were any.
bool hide_chunk(Json& gltf) {
  constexpr const char* byte_of_buffer = "data:application/octet-stream;base64,AA==";
  constexpr const char* byte_of_image = "data:image/png;base64,AA==";
  bool found = false;
  if (gltf.contains("buffers"))
    for (Json& buffer : gltf["buffers"])
      if (!buffer.contains("uri")) found = true, buffer = {{"byteLength", 1u}, {"uri", byte_of_buffer}};
  if (gltf.contains("images"))
    for (Json& image : gltf["images"])
      if (is_in_view(image) && !image.contains("uri")) found = true, image = {{"uri", byte_of_image}};
  return found;
}

/// A pair of braces in the document is hundreds of bytes of the model.
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

/// tinygltf may read less than the document said (a data URI that is no base64, say).
void take_buffers(const std::filesystem::path& file, const Json& gltf, const SourceBytes& bin, GltfDocument& out) {
  const Json& buffers = get_array(file, gltf, "", "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const bool is_bin = i == 0 && !bin.empty() && !buffers[i].contains("uri");
    const std::uint64_t bytes = get_index(file, buffers[i], "buffers", "byteLength").value_or(0);
    SourceBytes there = bin;
    if (!is_bin)
      there = i < out.model.buffers.size() ? SourceBytes(std::move(out.model.buffers[i].data)) : SourceBytes();
    if (there.size() < bytes && !is_absent_fallback(file, buffers[i], i, !bin.empty()))
      throw InputError(file, "buffers[" + std::to_string(i) + "]", "holds fewer bytes than its byteLength");
    out.buffers.push_back(there);
  }
  out.model.buffers.clear();
}

/// Images in views are where these are.
void take_images(const Json& gltf, bool with_images, GltfDocument& out) {
  for (std::size_t i = 0; i < out.images.size(); ++i) {
    const Json& image = gltf["images"][i];
    if (!is_in_view(image)) continue;
    const SourceBytes bytes = out.view_bytes(image["bufferView"].get<int>());
    out.has_image[i] = !bytes.empty();
    out.images[i] = with_images ? bytes : SourceBytes();
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
  const bool has_draco = hide_packed_indices(plain), has_chunk = hide_chunk(plain);
  const std::string text = has_draco || has_chunk || !packed.empty() ? plain.dump() : std::string();
  out.images.resize(get_array(file, json, "", "images").size());
  out.has_image.resize(out.images.size());
  out.rtc_center = container.rtc_center;
  out.instances = std::move(container.instances);
  const Json& extensions = get_object(file, json, "", "extensions");
  const Json& rtc = get_object(file, extensions, "extensions", "CESIUM_RTC");
  if (const auto center = get_numbers(file, rtc, "extensions.CESIUM_RTC", "center", 3))
    for (std::size_t c = 0; c < 3; ++c) out.rtc_center[c] += (*center)[c];
  claim_model(file, plain);
  LoadContext context{files, file, with_images, out};
  parse(
      text.empty() ? container.json.span() : std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()),
      context);
  take_buffers(file, json, container.bin, out);
  take_images(json, with_images, out);
  unpack_views(file, packed, out);
  unpack_draco(file, json, out);
  return out;
}

}  // namespace gigabake
