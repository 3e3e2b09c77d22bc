/// Queries and answers as NumPy arrays: the .npy format, versions 1 to 3, for long lists.
///
/// Source  https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "query/query_inputs.h"
#include "query/query_text.h"

namespace gigabake {

inline constexpr std::string_view npy_magic = "\x93NUMPY";

/// An open file of queries.
struct QueryFile {
  struct Close {
    void operator()(std::FILE* opened) const {
      if (opened != stdin) std::fclose(opened);
    }
  };
  std::filesystem::path path;  ///< for messages
  std::unique_ptr<std::FILE, Close> file;
};

/// Opens the file; "-" is standard input.
/// Errors  InputError.
QueryFile open_query_file(const std::filesystem::path& path);

/// Returns the queries of a two-dimensional array of little-endian doubles, one row per query. The magic bytes of
/// `file` must have been read already. A ray has the columns x, y, z, dx, dy, dz or x, y, z, azimuth, elevation. A
/// height query has the columns x, y. A line of sight has the columns x, y, z of both points. Geographic queries have
/// lon, lat, height instead of x, y, z, and never dx, dy, dz.
/// Errors  InputError with the offset of the byte, also from next(). Causes: an array of another type or shape, a
///         number that is not finite, a file of the wrong length.
std::unique_ptr<QuerySource> npy_queries(QueryFile file, QueryKind kind, QueryFrame frame, const ThreadPool& pool);

/// Returns the magic bytes and the header of a .npy file of `count` answers. `has_classes` adds a field `class`.
std::string npy_header(QueryKind kind, QueryFrame frame, std::uint64_t count, bool has_classes);
/// Appends the record of an answer.
void add_npy(const QueryAnswer& answer, QueryKind kind, const QueryFrames& frames, bool has_classes,
             std::string& bytes);

}  // namespace gigabake
