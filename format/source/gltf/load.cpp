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
  if (context.with_images) context.out.images[std::size_t(index)].assign(bytes, bytes + size);
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

void parse(const ContentContainer& container, LoadContext& context) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, &context);
  loader.SetFsCallbacks({file_exists, same_path, read_inside_root, nullptr, &context});
  std::string error, warning;
  const std::string base = context.file.has_parent_path() ? context.file.parent_path().string() : ".";
  const bool loaded = container.is_binary
                          ? loader.LoadBinaryFromMemory(&context.out.model, &error, &warning, container.gltf.data(),
                                                        unsigned(container.gltf.size()), base)
                          : loader.LoadASCIIFromString(&context.out.model, &error, &warning,
                                                       reinterpret_cast<const char*>(container.json.data()),
                                                       unsigned(container.json.size()), base);
  if (!loaded) throw InputError(context.file, "", first_line(error));
}

/// The container with another JSON text; `buffer` owns what it looks at.
void replace_json(const Json& json, std::vector<std::uint8_t>& buffer, ContentContainer& container) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto put = [&](const void* data, std::size_t bytes) {
    const auto* from = static_cast<const std::uint8_t*>(data);
    buffer.insert(buffer.end(), from, from + bytes);
  };
  const std::uint32_t text_bytes = std::uint32_t(text.size()), bin_bytes = std::uint32_t(container.bin.size());
  const std::uint32_t whole = 20 + text_bytes + (container.bin.empty() ? 0 : 8 + bin_bytes);
  const std::uint32_t head[] = {0x46546c67, 2, whole, text_bytes, 0x4e4f534a};  // "glTF", "JSON"
  const std::uint32_t chunk[] = {bin_bytes, 0x004e4942};                        // "BIN"
  put(head, sizeof head);
  put(text.data(), text.size());
  if (!container.bin.empty()) put(chunk, sizeof chunk), put(container.bin.data(), container.bin.size());
  container.gltf = buffer;
  container.json = std::span<const std::uint8_t>(buffer).subspan(20, text_bytes);
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
void check_buffers(const std::filesystem::path& file, const Json& json, const tinygltf::Model& model) {
  const Json& buffers = get_array(file, json, "", "buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i)
    if (i >= model.buffers.size() ||
        model.buffers[i].data.size() < get_index(file, buffers[i], "buffers", "byteLength").value_or(0))
      throw InputError(file, "buffers[" + std::to_string(i) + "]", "holds fewer bytes than its byteLength");
}

}  // namespace

GltfDocument load_gltf(const TileRef& tile, const std::filesystem::path& root, bool with_images) {
  GltfDocument out;
  const SourceFiles files = files_of(tile, root);
  ContentContainer container = open_container(tile, files);
  const std::filesystem::path& file = container.gltf_file;
  const Json json = parse_json(file, container.json);
  check_gltf(files, file, json, container.bin.size());
  const std::vector<PackedView> packed = packed_views(file, json, !container.bin.empty());
  Json plain = without_packed_views(json, packed);
  std::vector<std::uint8_t> plain_bytes;
  const bool has_draco = hide_packed_indices(plain);
  if (has_draco || !packed.empty()) replace_json(plain, plain_bytes, container);
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
  parse(container, context);
  check_buffers(file, plain, out.model);
  unpack_views(file, packed, out.model);
  unpack_draco(file, json, out.model);
  return out;
}

}  // namespace gigabake
