// Packs values into bytes, one after the other, and takes them out again in the same order, bit by bit the same: NaN and infinity too. For messages
// between ranks and for files that only this program reads, on machines of one byte order. The bytes do not say what they are: packing and unpacking
// must name the same values in the same order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace skyquilt::base {

// Numbers, and arrays and structs of them. Padding between the members of a struct is packed too, with whatever it holds.
template <typename T>
concept PlainValue = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>;

class BytePacker {
 public:
  template <PlainValue T>
  void Add(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void Add(const std::string& text) {
    AddCount(text.size());
    bytes_ += text;
  }
  template <PlainValue T>
  void Add(const std::vector<T>& values) {
    AddCount(values.size());
    if (!values.empty()) bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  // Of elements that are added one by one.
  void AddCount(size_t n) { Add(static_cast<uint64_t>(n)); }
  // Saves copying when about so many bytes will be packed.
  void Reserve(size_t n_bytes) { bytes_.reserve(n_bytes); }

  const std::string& bytes() const { return bytes_; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// Thrown for bytes that were not packed by the same program.
class UnreadableBytes : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ByteUnpacker {
 public:
  // The bytes must outlive it. message: of UnreadableBytes, which every function throws when the bytes end too early.
  ByteUnpacker(std::string_view bytes, std::string message) : bytes_(bytes), message_(std::move(message)) {}

  template <PlainValue T>
  void Take(T* value) {
    if constexpr (std::is_same_v<T, bool>) {
      const auto number = Take<uint8_t>();
      if (number > 1) Fail();
      *value = number == 1;
    } else {
      std::memcpy(static_cast<void*>(value), Next(sizeof(T)).data(), sizeof(T));
    }
  }
  void Take(std::string* text) { *text = Next(TakeCount(1)); }
  template <PlainValue T>
  void Take(std::vector<T>* values) {
    values->resize(TakeCount(sizeof(T)));
    if (!values->empty()) std::memcpy(static_cast<void*>(values->data()), Next(values->size() * sizeof(T)).data(), values->size() * sizeof(T));
  }
  template <typename T>
  T Take() {
    T value;
    Take(&value);
    return value;
  }
  // A number of elements that each take at least bytes_each > 0; checked against the bytes that are left.
  size_t TakeCount(size_t bytes_each);
  // Throws unless all bytes were taken.
  void End() const;
  [[noreturn]] void Fail() const;

 private:
  std::string_view Next(size_t n);

  std::string_view bytes_;  // that are left
  std::string message_;
};

}  // namespace skyquilt::base
