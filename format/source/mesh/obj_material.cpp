#include "format/source/mesh/obj_material.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "core/base/error.h"
#include "format/source/source_file.h"

namespace gigabake {
namespace {

bool is_number(std::string_view word) {
  double v = 0;
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  const auto end = std::from_chars(word.data(), word.data() + word.size(), v);
  return !word.empty() && end.ec == std::errc() && end.ptr == word.data() + word.size();
}

std::string in_lower_case(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return out;
}

/// A reader of MTL files that receives one line at a time.
class MtlReader {
 public:
  MtlReader(const std::filesystem::path& file, SourceWarnings& warnings)
      : file_name_(file.filename().string()), warnings_(warnings) {}

  void take(const ObjLine& line) {
    line_ = &line;
    const std::string key = in_lower_case(line.word);
    if (key == "newmtl") {
      current_ = &materials_[std::string(line.rest)];
      return;
    }
    if (current_ == nullptr) return warn("MTL lines before the first newmtl");
    ObjMaterial& material = current_->material;
    if (key == "kd")
      take_colour(material);
    else if (key == "d" && !line.rest.starts_with("-halo"))
      current_->dissolve = opacity();
    else if (key == "tr")
      current_->transparency = opacity();
    else if (key == "map_kd")
      material.color_map = map();
    else if (key == "map_d" || key == "map_opacity")
      material.alpha_map = map();
    else if (key == "norm" || key == "map_norm")
      material.normal_map = map(), current_->has_norm = true;
    else if ((key == "bump" || key == "map_bump") && !current_->has_norm)
      material.normal_map = map();
    else if (!is_lighting(key))
      warn("MTL lines not understood");
  }

  std::map<std::string, ObjMaterial> finish() {
    std::map<std::string, ObjMaterial> out;
    for (auto& [name, m] : materials_) {
      m.material.base_color[3] = alpha_of(m);
      out[name] = std::move(m.material);
    }
    return out;
  }

 private:
  struct Entry {
    ObjMaterial material;
    std::optional<double> dissolve, transparency;
    bool has_norm = false;  ///< `norm` has precedence over `bump`
  };

  static float clamped(double v) { return v >= 0 ? float(std::min(v, 1.0)) : 0.0f; }

  static float alpha_of(const Entry& entry) {
    if (entry.dissolve) return clamped(*entry.dissolve);
    if (!entry.transparency || *entry.transparency == 1) return 1;
    return clamped(1 - *entry.transparency);
  }

  /// Returns whether the keyword describes lighting or displacement, which are not used.
  static bool is_lighting(const std::string& key) {
    static const char* const keys[] = {"ka",        "ks",     "ke",     "ns",       "ni",       "tf",       "illum",
                                       "sharpness", "map_ka", "map_ks", "map_ke",   "map_ns",   "bump",     "disp",
                                       "decal",     "refl",   "norm",   "pr",       "pm",       "ps",       "pc",
                                       "pcr",       "aniso",  "anisor", "map_pr",   "map_pm",   "map_ps",   "map_norm",
                                       "map_aat",   "km",     "map_tr", "map_refl", "map_bump", "map_disp", "d"};
    return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
  }

  void warn(const char* text) {
    warnings_.count(text, "line " + std::to_string(line_->number) + " of " + in_quotes(file_name_));
  }

  std::optional<double> opacity() {
    const std::vector<double> v = obj_numbers(line_->rest, 1);
    if (v.empty()) warn("MTL lines not understood");
    if (v.empty()) return std::nullopt;
    if (!(v[0] >= 0 && v[0] <= 1)) warn("opacities (d, Tr) outside 0 to 1, taken as the nearer of both");
    return v[0];
  }

  void take_colour(ObjMaterial& material) {
    const std::vector<double> v = obj_numbers(line_->rest, 3);
    // Kd has one or three numbers; a spectrum or CIE XYZ is not read.
    if (v.size() != 1 && v.size() != 3) return warn("MTL lines not understood");
    for (std::size_t c = 0; c < 3; ++c) material.base_color[c] = clamped(v[std::min(c, v.size() - 1)]);
    if (std::any_of(v.begin(), v.end(), [](double one) { return one > 1; })) warn("colours (Kd) above 1, taken as 1");
    if (!std::all_of(v.begin(), v.end(), [](double one) { return one >= 0; }))
      warn("colours (Kd) below 0 or not a number, taken as 0");
  }

  /// Reads a line like "-s 2 2 1 -clamp on name of file.png": options with values, then a name that may have spaces.
  ObjMap map() {
    ObjMap out;
    std::string_view rest = line_->rest;
    while (rest.size() > 1 && rest[0] == '-') {
      std::string_view after = rest;
      const std::string option = in_lower_case(take_word(after));
      if (after.empty()) break;  // a name that begins with a dash
      take_option(option, after, out);
      rest = after;
    }
    out.name = rest;
    return out;
  }

  void take_option(const std::string& option, std::string_view& rest, ObjMap& out) {
    std::string_view next = rest;
    const std::string_view value = take_word(next);
    if (!is_number(value)) {
      rest = next;  // the value is on, off or a channel
      if (option == "-clamp") out.is_clamped = value == "on";
      return;
    }
    const std::size_t max_count = option == "-s" || option == "-o" || option == "-t" ? 3 : option == "-mm" ? 2 : 1;
    std::vector<double> values;
    for (next = rest; values.size() < max_count && is_number(value_of(next)); rest = next)
      values.push_back(obj_numbers(take_word(next), 1).front());
    const auto first_two = [&](double missing) {
      return std::array<double, 2>{values[0], values.size() > 1 ? values[1] : missing};
    };
    if (option == "-s") out.scale = first_two(1);
    if (option == "-o") out.offset = first_two(0);
    if (option == "-bm") out.bump_scale = values[0];
    const bool is_unused =
        (option == "-t" && std::any_of(values.begin(), values.end(), [](double v) { return v != 0; })) ||
        (option == "-mm" && values != std::vector<double>{0, 1});
    if (is_unused) warn("options of images that are not applied (-t, -mm)");
  }

  static std::string_view value_of(std::string_view rest) { return take_word(rest); }

  std::string file_name_;
  SourceWarnings& warnings_;
  const ObjLine* line_ = nullptr;
  std::map<std::string, Entry> materials_;
  Entry* current_ = nullptr;
};

}  // namespace

std::array<float, 2> ObjMap::uv(const std::array<float, 2>& uv) const {
  return {float(double(uv[0]) * scale[0] + offset[0]), float(1 - ((1 - double(uv[1])) * scale[1] + offset[1]))};
}

std::map<std::string, ObjMaterial> read_mtl(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                                            SourceWarnings& warnings) {
  MtlReader reader(file, warnings);
  for_each_obj_line(file, text, [&](const ObjLine& line) { reader.take(line); });
  return reader.finish();
}

NamedFile named_file(const std::filesystem::path& base, std::string_view name, const SourceFiles& files) {
  const std::string plain = plain_name(name);
  for (const std::string& one : {plain, std::filesystem::path(plain).filename().string()}) {
    try {
      return {std::string(name), resolve_path(files.root(), base, "", one)};
    } catch (const InputError&) {
      // The path is outside the folder of the source. The next attempt uses only the last component of the path.
    }
  }
  return {std::string(name), std::nullopt};
}

std::vector<NamedFile> material_files(const std::filesystem::path& file, const ObjLine& line,
                                      const SourceFiles& files) {
  if (line.rest.empty()) return {};
  for (const std::string_view name : {line.rest, without_comment(line.rest)})
    if (const NamedFile whole = named_file(file, name, files); whole.is_there(files)) return {whole};
  std::vector<NamedFile> out;
  for (std::string_view rest = without_comment(line.rest); !rest.empty();)
    out.push_back(named_file(file, take_word(rest), files));
  return out;
}

}  // namespace gigabake
