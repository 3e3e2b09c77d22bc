// check_unused_states(): checks the parts of a glTF document that no bake uses.
#include <algorithm>
#include <string>

#include "core/base/error.h"
#include "format/source/gltf/check.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

std::string item(const std::string& list, std::size_t i) { return list + "[" + std::to_string(i) + "]"; }

/// Calls visit(item, path of the item) for each item of a list of objects.
template <class Visit>
void for_each(const Path& file, const Json& object, const std::string& where, const char* key, const Visit& visit) {
  const Json& items = get_array(file, object, where, key);
  const std::string list = where.empty() ? key : where + "." + key;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!items[i].is_object()) throw InputError(file, item(list, i), "expected an object");
    visit(items[i], item(list, i));
  }
}

void expect_integer(const Path& file, const Json& object, const std::string& where, const char* key) {
  const auto value = object.find(key);
  if (value == object.end() || !value->is_number_integer())
    throw InputError(file, where + "." + key, "expected a whole number");
}

void check_animation(const Path& file, const Json& animation, const std::string& where) {
  if (!animation.contains("samplers") || !animation["samplers"].is_array()) return;
  for_each(file, animation, where, "samplers", [&](const Json& sampler, const std::string& at) {
    for (const char* key : {"input", "output"}) expect_integer(file, sampler, at, key);
  });
}

void check_skin(const Path& file, const Json& skin, const std::string& where) {
  const auto joints = skin.find("joints");
  if (joints == skin.end() || !joints->is_array() ||
      !std::all_of(joints->begin(), joints->end(), [](const Json& joint) { return joint.is_number_integer(); }))
    throw InputError(file, where + ".joints", "expected a list of whole numbers");
}

void check_camera(const Path& file, const Json& camera, const std::string& where) {
  const std::string type = get_text(file, camera, where, "type").value_or("");
  if (type != "orthographic" && type != "perspective")
    throw InputError(file, where + ".type", "expected orthographic or perspective");
  const Json& lens = get_object(file, camera, where, type.c_str());
  const auto expect_number = [&](const char* key) {
    const auto value = lens.find(key);
    if (value == lens.end() || !value->is_number())
      throw InputError(file, where + "." + type + "." + key, "expected a number");
  };
  if (type == "perspective")
    for (const char* key : {"yfov", "znear"}) expect_number(key);
  else
    for (const char* key : {"xmag", "ymag", "zfar", "znear"}) expect_number(key);
}

void check_lights(const Path& file, const Json& gltf) {
  const Json& extensions = get_object(file, gltf, "", "extensions");
  const auto extension = extensions.find("KHR_lights_punctual");
  if (extension == extensions.end() || !extension->is_object()) return;
  const std::string where = "extensions.KHR_lights_punctual";
  if (!extension->contains("lights") || !(*extension)["lights"].is_array()) return;
  for_each(file, *extension, where, "lights", [&](const Json& light, const std::string& at) {
    const auto type = get_text(file, light, at, "type");
    if (!type) throw InputError(file, at + ".type", "is missing");
    if (*type == "spot" && (!light.contains("spot") || !light["spot"].is_object()))
      throw InputError(file, at + ".spot", "expected an object");
  });
}

}  // namespace

void check_unused_states(const std::filesystem::path& file, const Json& gltf) {
  for_each(file, gltf, "", "animations",
           [&](const Json& animation, const std::string& where) { check_animation(file, animation, where); });
  for_each(file, gltf, "", "skins", [&](const Json& skin, const std::string& where) { check_skin(file, skin, where); });
  for_each(file, gltf, "", "cameras",
           [&](const Json& camera, const std::string& where) { check_camera(file, camera, where); });
  check_lights(file, gltf);
}

}  // namespace gigabake
