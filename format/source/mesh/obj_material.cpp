#include "format/source/mesh/obj_material.h"

#include <algorithm>
#include <charconv>

#include "format/source/source_file.h"
#include "lattice/counted.h"
#include "lattice/error.h"

namespace gigabake {
namespace {

bool is_number(std::string_view word) {
  double v = 0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), v);
  return end.ec == std::errc() && end.ptr == word.data() + word.size();
}

std::string_view first_word(std::string_view text) { return take_word(text); }

/// "-s 1 1 1 -clamp on name of file.png": options are skipped with what belongs to them.
std::string map_name(std::string_view rest) {
  while (rest.size() > 1 && rest[0] == '-') {
    std::string_view after = rest;
    take_word(after);
    if (after.empty()) break;
    std::string_view next = after;
    const std::string_view value = take_word(next);
    if (!is_number(value)) {
      after = next;  // on, off, a channel
    } else {
      while (is_number(first_word(after)) && !after.empty()) take_word(after);
    }
    rest = after;
  }
  std::string name(rest);
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

}  // namespace

std::map<std::string, ObjMaterial> read_mtl(const std::filesystem::path& file, std::span<const std::uint8_t> text) {
  std::map<std::string, ObjMaterial> out;
  ObjMaterial* material = nullptr;
  for_each_obj_line(file, text, [&](const ObjLine& line) {
    const auto numbers = [&](std::size_t count) {
      const std::vector<double> v = obj_numbers(line.rest, count);
      if (v.size() != count)
        throw InputError(file, "line " + std::to_string(line.number), "expected " + counted(count, "number"));
      return v;
    };
    const auto unit = [](double v) { return v >= 0 ? float(std::min(v, 1.0)) : 0.0f; };
    if (line.word == "newmtl") material = &out[std::string(line.rest)];
    if (material == nullptr) return;
    if (line.word == "Kd" && !line.rest.starts_with("spectral") && !line.rest.starts_with("xyz")) {
      const std::vector<double> v = numbers(3);
      for (std::size_t c = 0; c < 3; ++c) material->base_color[c] = unit(v[c]);
    }
    if (line.word == "d" && !line.rest.starts_with("-halo")) material->base_color[3] = unit(numbers(1)[0]);
    if (line.word == "Tr") material->base_color[3] = unit(1 - numbers(1)[0]);
    if (line.word == "map_Kd") material->color_map = map_name(line.rest);
    if (line.word == "map_d") material->alpha_map = map_name(line.rest);
  });
  for (auto& [name, m] : out)
    if (!m.color_map.empty()) m.base_color = {1, 1, 1, m.base_color[3]};
  return out;
}

std::vector<std::filesystem::path> material_files(const std::filesystem::path& file, const ObjLine& line,
                                                  const SourceFiles& files) {
  const std::string key = "line " + std::to_string(line.number);
  std::string all(line.rest);
  std::replace(all.begin(), all.end(), '\\', '/');
  const std::filesystem::path whole = resolve_path(files.root(), file, key, all);
  if (files.has(whole)) return {whole};
  std::vector<std::filesystem::path> out;
  for (std::string_view rest = all; !rest.empty();) {
    const std::string name(take_word(rest));
    out.push_back(resolve_path(files.root(), file, key, name));
  }
  return out;
}

std::filesystem::path map_file(const std::filesystem::path& mtl_file, const std::string& name,
                               const SourceFiles& files) {
  std::filesystem::path file = resolve_path(files.root(), mtl_file, "map_Kd or map_d", name);
  if (!files.has(file)) throw InputError(mtl_file, "map_Kd or map_d", "the image " + in_quotes(name) + " is missing");
  return file;
}

}  // namespace gigabake
