/// Functions that damage a file in many ways, one at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace gigabake::made {

/// Callback that receives a description of the damage, including the seed.
using Damage = std::function<void(const std::string& what)>;

/// Changes one bit of a byte, or the whole byte, and calls `damage`. Continues one to three bytes later, with all other
/// bytes intact.
void for_each_changed_byte(const std::filesystem::path& path, std::uint64_t seed, const Damage& damage);

/// Replaces a random stretch of up to 600 bytes by zeros, ones or noise, 300 times. The other bytes stay intact.
void for_each_overwritten_stretch(const std::filesystem::path& path, std::uint64_t seed, const Damage& damage);

/// Truncates the file further before each call of `damage`, until it is empty.
void for_each_cut(const std::filesystem::path& path, const Damage& damage);

}  // namespace gigabake::made
