/// The materials that an OBJ names, with the descriptions in its material files and the paths of their images.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "format/source/mesh/obj_material.h"
#include "format/source/source.h"

namespace gigabake {

/// A material name of an OBJ, and the attributes of the faces that use it. Faces with and without texture coordinates
/// or colours get separate materials, even if the name is the same.
struct ObjMaterialUse {
  std::string name;
  bool has_uv = false, has_colour = false;

  friend auto operator<=>(const ObjMaterialUse&, const ObjMaterialUse&) = default;
};

class ObjMaterialTable {
 public:
  /// `file` and `files` must outlive the table.
  ObjMaterialTable(const std::filesystem::path& file, const SourceFiles& files) : file_(file), files_(files) {}

  /// Reads the files that an `mtllib` line names.
  /// Errors  InputError: a material file is not text.
  void take(const ObjLine& line);

  /// Adds warnings about material files, descriptions and images that are missing. `used` has the names of the
  /// materials of all faces.
  void warn(const std::set<std::string>& used, SourceWarnings& warnings) const;
  /// Returns the sorted paths of all named material files and their images, existing or missing.
  std::vector<std::filesystem::path> dependencies() const;
  /// Returns whether the material has an image that can be read.
  bool has_image(const std::string& name) const;

  /// Counts normal maps of a used material that are not used, with the reason.
  /// Cost    Decodes rows of the map up to the first coloured texel.
  void warn_of_normal_map(const ObjMaterialUse& use, SourceWarnings& warnings) const;
  /// Appends the material, its image, and its normal map if `with_normals`. Returns its index in out.materials.
  int add(const ObjMaterialUse& use, bool with_normals, TileMesh& out);
  /// Returns the placement of the material's normal map; nullopt if none is used.
  std::optional<ObjMap> placed_normal_map(const ObjMaterialUse& use) const;
  /// Returns the placement of the material's image.
  ObjMap placed_map(const std::string& name) const;

 private:
  /// A material and the path of the file that describes it.
  struct Described {
    ObjMaterial material;
    std::filesystem::path file;
  };
  void describe(const std::string& name, Described described);
  const Described* find(const std::string& name) const;
  bool is_usable(const Described& material, const ObjMap& map) const;
  /// Returns whether the material has an image of directions. Grey images are height maps.
  bool has_normal_map(const Described& material) const;
  EncodedImage load(const Described& material, const ObjMap& map) const;
  int add_image(const Described& material, const ObjMap& color, const ObjMap& alpha, TileMesh& out);

  const std::filesystem::path& file_;
  const SourceFiles& files_;
  std::map<std::string, Described> described_;
  std::set<std::filesystem::path> mtl_files_;
  std::set<std::string> missing_;  ///< names of missing material files
  SourceWarnings mtl_warnings_;
  std::map<std::string, int> image_;
  mutable std::map<std::filesystem::path, bool> is_grey_;  ///< results of is_grey(), by path of the image
};

}  // namespace gigabake
