#include "format/gltf_load.h"

#include "format/error.h"
#include "format/gltf_check.h"

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
  if (context.with_images && index >= 0 && std::size_t(index) < context.out.images.size())
    context.out.images[std::size_t(index)].assign(bytes, bytes + size);
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
    *out = context.files.read(target);
    return true;
  } catch (const std::exception& e) {
    if (error != nullptr) *error += e.what();
    return false;
  }
}

std::string first_line(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return "cannot be read as glTF";
  return text.substr(begin, text.find_first_of("\r\n", begin) - begin);
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
  out.images.resize(get_array(file, json, "", "images").size());
  out.rtc_center = container.rtc_center;
  out.instances = std::move(container.instances);
  const Json& extensions = get_object(file, json, "", "extensions");
  const Json& rtc = get_object(file, extensions, "extensions", "CESIUM_RTC");
  if (const auto center = get_numbers(file, rtc, "extensions.CESIUM_RTC", "center", 3))
    for (std::size_t c = 0; c < 3; ++c) out.rtc_center[c] += (*center)[c];
  LoadContext context{files, file, with_images, out};
  parse(container, context);
  check_buffers(file, json, out.model);
  return out;
}

}  // namespace gigabake
