#include "format/source/gltf/packed_views.h"

#include "core/base/error.h"

namespace gigabake {
namespace {

constexpr const char* meshopt_extension = "EXT_meshopt_compression";
/// Max ratio of unpacked to packed bytes, because the vertex codec needs at least 4 bytes for 256 equal bytes. Short
/// streams may have slack_bytes more.
constexpr std::uint64_t max_expansion_ratio = 64, slack_bytes = 1 << 16;

std::string where_of(std::size_t view) {
  return "bufferViews[" + std::to_string(view) + "].extensions." + meshopt_extension;
}

/// Returns the enum value that member `key` names. If there is no such member, uses the name `otherwise`.
template <class Enum>
Enum get_named(const std::filesystem::path& file, const Json& json, const std::string& where, const char* key,
               std::string_view otherwise) {
  const std::string name = get_text(file, json, where, key).value_or(std::string(otherwise));
  const std::optional<Enum> value = value_named<Enum>(name);
  if (!value) throw InputError(file, where + "." + key, "is unknown: " + in_quotes(name));
  return *value;
}

MeshoptStream stream_of(const std::filesystem::path& file, const Json& json, const std::string& where) {
  MeshoptStream s;
  s.count = get_index(file, json, where, "count").value_or(0);
  s.stride = get_index(file, json, where, "byteStride").value_or(0);
  s.mode = get_named<MeshoptMode>(file, json, where, "mode", "");
  s.filter = get_named<MeshoptFilter>(file, json, where, "filter", name_of(MeshoptFilter::none));
  const bool is_index = s.mode != MeshoptMode::attributes;
  if (is_index ? s.stride != 2 && s.stride != 4 : s.stride == 0 || s.stride > 256 || s.stride % 4 != 0)
    throw InputError(file, where + ".byteStride",
                     is_index ? "expected 2 or 4" : "expected a multiple of 4, at most 256");
  if (s.mode == MeshoptMode::triangles && s.count % 3 != 0)
    throw InputError(file, where + ".count", "expected a multiple of 3");
  if ((s.filter == MeshoptFilter::octahedral && s.stride != 4 && s.stride != 8) ||
      (s.filter == MeshoptFilter::quaternion && s.stride != 8) || (is_index && s.filter != MeshoptFilter::none))
    throw InputError(file, where + ".filter", "does not match the mode and the stride");
  return s;
}

PackedView packed_view(const std::filesystem::path& file, const Json& gltf, std::size_t index) {
  const Json& view = gltf["bufferViews"][index];
  const std::string where = where_of(index);
  const Json& json = get_object(file, view["extensions"], where, meshopt_extension);
  PackedView out;
  out.view = index;
  out.byte_stride = get_index(file, view, where, "byteStride").value_or(0);
  const auto buffer = get_index(file, json, where, "buffer");
  if (!buffer || *buffer >= gltf["buffers"].size())
    throw InputError(file, where + ".buffer", "expected one of the buffers");
  out.buffer = *buffer;
  out.byte_offset = get_index(file, json, where, "byteOffset").value_or(0);
  out.byte_length = get_index(file, json, where, "byteLength").value_or(0);
  const std::uint64_t whole = get_index(file, gltf["buffers"][out.buffer], "buffers", "byteLength").value_or(0);
  if (out.byte_offset > whole || out.byte_length > whole - out.byte_offset || out.byte_length == 0)
    throw InputError(file, where, "its bytes exceed a buffer of " + std::to_string(whole));
  out.stream = stream_of(file, json, where);
  const std::uint64_t bytes = get_index(file, view, where, "byteLength").value_or(0);
  if (out.stream.count > bytes / out.stream.stride || out.stream.count * out.stream.stride != bytes)
    throw InputError(file, where, "count times byteStride is not the view's byteLength");
  if (bytes > slack_bytes && (bytes - slack_bytes) / max_expansion_ratio > out.byte_length)
    throw InputError(
        file, where,
        std::to_string(bytes) + " bytes are more than " + std::to_string(out.byte_length) + " packed bytes can hold");
  return out;
}

}  // namespace

bool is_absent_fallback(const std::filesystem::path& file, const Json& buffer, std::size_t index, bool has_bin) {
  if (buffer.contains("uri") || (index == 0 && has_bin)) return false;
  const Json& own = get_object(file, get_object(file, buffer, "buffers", "extensions"), "buffers", meshopt_extension);
  return own.contains("fallback") && own["fallback"].is_boolean() && own["fallback"].get<bool>();
}

std::vector<PackedView> packed_views(const std::filesystem::path& file, const Json& gltf, bool has_bin) {
  std::vector<PackedView> out;
  const Json& buffers = get_array(file, gltf, "", "buffers");
  const auto is_absent = [&](std::size_t i) { return is_absent_fallback(file, buffers[i], i, has_bin); };
  const Json& views = get_array(file, gltf, "", "bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!is_absent(views[i]["buffer"].get<std::size_t>())) continue;
    if (!get_object(file, views[i], "bufferViews", "extensions").contains(meshopt_extension))
      throw InputError(file, "bufferViews[" + std::to_string(i) + "]", "lies in a buffer that has no bytes");
    out.push_back(packed_view(file, gltf, i));
    if (is_absent(out.back().buffer)) throw InputError(file, where_of(i) + ".buffer", "has no bytes");
  }
  return out;
}

void refer_to_packed_bytes(const std::vector<PackedView>& packed, tinygltf::Model& model) {
  for (const PackedView& p : packed) {
    tinygltf::BufferView& view = model.bufferViews[p.view];
    view.buffer = int(p.buffer);
    view.byteOffset = p.byte_offset;
    view.byteLength = p.byte_length;
    view.byteStride = 0;
  }
}

void unpack_views(const std::filesystem::path& file, const std::vector<PackedView>& packed, GltfDocument& document) {
  std::vector<std::uint8_t> buffer;
  for (const PackedView& p : packed) {
    const SourceBytes& from = document.buffers[p.buffer];
    if (p.byte_offset + p.byte_length > from.size()) throw InputError(file, where_of(p.view), "exceeds its buffer");
    std::vector<std::uint8_t> plain =
        decode_meshopt(file, where_of(p.view), p.stream, from.look(p.byte_offset, p.byte_length, buffer));
    tinygltf::BufferView& view = document.model.bufferViews[p.view];
    view.byteOffset = 0;
    view.byteLength = plain.size();
    view.byteStride = p.byte_stride;
    view.buffer = document.add_buffer(std::move(plain));
  }
}

}  // namespace gigabake
