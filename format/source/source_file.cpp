#include "format/source/source_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "core/base/quote.h"
#include "format/system/json/json_members.h"
#include "format/system/path_within.h"

namespace gigabake {

std::optional<std::uint64_t> get_index(const std::filesystem::path& file, const Json& object, const std::string& where,
                                       const char* key) {
  return JsonMembers(file, object, where).find<std::uint64_t>(key);
}

std::optional<double> get_number(const std::filesystem::path& file, const Json& object, const std::string& where,
                                 const char* key) {
  return JsonMembers(file, object, where).find<double>(key);
}

std::optional<std::string> get_text(const std::filesystem::path& file, const Json& object, const std::string& where,
                                    const char* key) {
  return JsonMembers(file, object, where).find<std::string>(key);
}

std::optional<std::vector<double>> get_numbers(const std::filesystem::path& file, const Json& object,
                                               const std::string& where, const char* key, std::size_t count) {
  return JsonMembers(file, object, where).numbers(key, count);
}

const Json& get_array(const std::filesystem::path& file, const Json& object, const std::string& where,
                      const char* key) {
  return JsonMembers(file, object, where).array(key);
}

const Json& get_object(const std::filesystem::path& file, const Json& object, const std::string& where,
                       const char* key) {
  return JsonMembers(file, object, where).object(key);
}

std::string percent_decoded(std::string_view text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      out += char(digit(text[i + 1]) * 16 + digit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string uri_path(std::string_view uri) {
  std::string path(uri.substr(0, uri.find_first_of("?#")));
  std::replace(path.begin(), path.end(), '\\', '/');
  return percent_decoded(path);
}

std::filesystem::path resolve_uri(const std::filesystem::path& root, const std::filesystem::path& base,
                                  const std::string& key, std::string_view uri) {
  return resolve_path(root, base, key, uri_path(uri));
}

std::filesystem::path resolve_path(const std::filesystem::path& root, const std::filesystem::path& base,
                                   const std::string& key, const std::string& text) {
  if (text.empty() || text.find('\0') != std::string::npos)
    throw InputError(base, key, "expected the path of a file, got " + in_quotes(text));
  if (const auto colon = text.find(':'); colon != std::string::npos && colon < text.find('/'))
    throw InputError(base, key, "expected a path relative to the file, got " + in_quotes(text));
  const std::filesystem::path relative(text);
  std::error_code error;
  const std::filesystem::path target =
      std::filesystem::weakly_canonical(std::filesystem::absolute(base, error).parent_path() / relative, error);
  if (error) throw InputError(base, key, in_quotes(text) + " cannot be resolved: " + error.message());
  if (relative.is_absolute() || !is_within(std::filesystem::weakly_canonical(root, error), target))
    throw InputError(base, key, in_quotes(text) + " leaves the source folder " + short_path(root.string()));
  return target;
}

std::filesystem::path resolve_name(const std::filesystem::path& root, const std::filesystem::path& base,
                                   const std::string& key, const std::string& name) {
  std::error_code error;
  if (name.find('\\') != std::string::npos && !std::filesystem::exists(base.parent_path() / name, error)) {
    std::string with_slashes = name;
    std::replace(with_slashes.begin(), with_slashes.end(), '\\', '/');
    return resolve_path(root, base, key, with_slashes);
  }
  return resolve_path(root, base, key, name);
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string e = path.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return e;
}

std::string name_in(const std::filesystem::path& root, const std::filesystem::path& path) {
  std::error_code error;
  const auto relative =
      std::filesystem::weakly_canonical(path, error).lexically_relative(std::filesystem::weakly_canonical(root, error));
  return relative.empty() ? path.generic_string() : relative.generic_string();
}

}  // namespace gigabake
