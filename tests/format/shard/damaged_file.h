/// A file damaged in many ways, one after the other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace gigabake::made {

/// Told what was done to the file, with the seed.
using Damage = std::function<void(const std::string& what)>;

/// Every few bytes one is another, in one bit or in any; the rest is whole.
void for_each_changed_byte(const std::filesystem::path& path, std::uint64_t seed, const Damage& damage);

/// 300 times a stretch of up to 600 bytes is zeros, ones or noise; the rest is whole.
void for_each_overwritten_stretch(const std::filesystem::path& path, std::uint64_t seed, const Damage& damage);

/// Shorter each time, down to nothing.
void for_each_cut(const std::filesystem::path& path, const Damage& damage);

}  // namespace gigabake::made
