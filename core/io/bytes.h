/// Serialization of plain values for messages between ranks: little endian, lengths before contents.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/error.h"
#include "core/base/rules.h"

namespace gigabake {

class ByteWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) {
    const auto* from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof(T));
  }
  void put(const std::string& text) {
    put(std::uint64_t(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(std::uint64_t(values.size()));
    if constexpr (std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>) {
      const auto* from = reinterpret_cast<const std::uint8_t*>(values.data());
      bytes_.insert(bytes_.end(), from, from + values.size() * sizeof(T));
    } else {
      for (const T& v : values) put(v);
    }
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// A reader for bytes that ByteWriter wrote.
/// Errors  InputError from each get() that would read beyond the end, and from expect_end().
class ByteReader {
 public:
  ByteReader(std::span<const std::uint8_t> bytes, const char* what) : bytes_(bytes), what_(what) {}

  template <class T>
  requires(std::is_trivially_copyable_v<T> && !std::is_enum_v<T>) void get(T& value) {
    need(sizeof(T));
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
  }
  /// Reads the number of an enum's value.
  /// Errors  InputError with the number if the enum has no such value.
  template <class Enum>
  requires std::is_enum_v<Enum>
  void get(Enum& value) {
    std::underlying_type_t<Enum> number{};
    get(number);
    const std::optional<Enum> known = value_numbered<Enum>(std::uint64_t(number));
    if (!known) fail("holds " + std::to_string(number) + ", expected the number of one of " + all_names<Enum>());
    value = *known;
  }
  void get(bool& value) {
    std::uint8_t byte = 0;
    get(byte);
    if (byte > 1) fail("holds " + std::to_string(byte) + ", expected 0 or 1");
    value = byte == 1;
  }
  void get(std::string& text) {
    const std::uint64_t size = length(1);
    text.assign(reinterpret_cast<const char*>(bytes_.data()) + at_, size);
    at_ += size;
  }
  template <class T>
  void get(std::vector<T>& values) {
    const std::uint64_t count = length(std::is_trivially_copyable_v<T> ? sizeof(T) : 8);
    values.resize(count);
    if constexpr (std::is_trivially_copyable_v<T> && !std::is_enum_v<T> && !std::is_same_v<T, bool>) {
      if (count != 0) std::memcpy(values.data(), bytes_.data() + at_, count * sizeof(T));
      at_ += count * sizeof(T);
    } else {
      for (T& v : values) get(v);
    }
  }
  void expect_end() const {
    if (at_ != bytes_.size()) fail("has bytes after its end");
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InputError(what_, "", message, at_); }
  void need(std::uint64_t size) const {
    if (size > bytes_.size() - at_) fail("ends early");
  }
  /// Reads a count and checks that this many items of at least `item_bytes` each fit into the remaining bytes.
  std::uint64_t length(std::uint64_t item_bytes) {
    std::uint64_t count = 0;
    get(count);
    if (count > (bytes_.size() - at_) / item_bytes) fail("has a length beyond its end");
    return count;
  }

  std::span<const std::uint8_t> bytes_;
  const char* what_;
  std::size_t at_ = 0;
};

/// Writes whether there is a value, and the value.
template <class Value>
void put_optional(ByteWriter& w, const std::optional<Value>& value) {
  w.put(std::uint8_t(value.has_value()));
  if (value) w.put(*value);
}

/// Reads what put_optional() wrote.
template <class Value>
void get_optional(ByteReader& r, std::optional<Value>& value) {
  bool is_there = false;
  r.get(is_there);
  value.reset();
  if (is_there) r.get(value.emplace());
}

}  // namespace gigabake
