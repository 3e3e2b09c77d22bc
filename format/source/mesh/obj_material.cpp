#include "format/source/mesh/obj_material.h"

#include <algorithm>
#include <charconv>

#include "format/source/source_file.h"
#include "lattice/counted.h"
#include "lattice/error.h"

namespace gigabake {
namespace {

constexpr std::string_view blank = " \t\r\f\v";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::string_view take_word(std::string_view& rest) {
  const std::string_view word = rest.substr(0, rest.find_first_of(blank));
  rest = trimmed(rest.substr(word.size()));
  return word;
}

bool is_number(std::string_view word) {
  double v = 0;
  const auto end = std::from_chars(word.data(), word.data() + word.size(), v);
  return end.ec == std::errc() && end.ptr == word.data() + word.size();
}

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
      while (is_number(std::string_view(after).substr(0, after.find_first_of(blank))) && !after.empty())
        take_word(after);
    }
    rest = after;
  }
  std::string name(rest);
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

}  // namespace

std::span<const std::uint8_t> whole_lines(std::span<const std::uint8_t> head) {
  std::size_t bytes = head.size();
  while (bytes > 0 && head[bytes - 1] != '\n') --bytes;
  return head.first(bytes);
}

void for_each_obj_line(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                       const std::function<void(const ObjLine&)>& visit) {
  const std::string_view all(reinterpret_cast<const char*>(text.data()), text.size());
  if (all.find('\0') != std::string_view::npos)
    throw InputError(file, "", "expected text in ASCII or UTF-8", all.find('\0'));
  std::string joined;
  std::size_t number = 0;
  for (std::size_t at = 0; at < all.size();) {
    const std::size_t end = std::min(all.find('\n', at), all.size());
    std::string_view line = trimmed(all.substr(at, end - at));
    at = end + 1;
    ++number;
    if (!line.empty() && line.back() == '\\') {
      joined += std::string(line.substr(0, line.size() - 1)) + ' ';
      if (at < all.size()) continue;
      line = {};
    }
    if (!joined.empty()) {
      joined += line;
      line = trimmed(joined);
    }
    if (!line.empty() && line[0] != '#') {
      std::string_view rest = line;
      const std::string_view word = take_word(rest);
      visit({number, word, rest});
    }
    joined.clear();
  }
}

std::vector<double> obj_numbers(std::string_view text, std::size_t most) {
  std::vector<double> out;
  while (out.size() < most && !text.empty()) {
    std::string_view word = take_word(text);
    if (word.starts_with('+')) word.remove_prefix(1);
    double v = 0;
    const auto end = std::from_chars(word.data(), word.data() + word.size(), v);
    if (end.ec != std::errc() || end.ptr != word.data() + word.size()) break;
    out.push_back(v);
  }
  return out;
}

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
