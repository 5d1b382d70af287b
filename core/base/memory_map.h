// A read-only view of a whole file. The system loads and drops pages on demand, so a file may be larger than memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace skyquilt::base {

class MemoryMap {
 public:
  MemoryMap() = default;
  // Throws InputError if the file cannot be opened or mapped. An empty file maps to an empty span.
  explicit MemoryMap(const std::filesystem::path& file);
  ~MemoryMap();
  MemoryMap(MemoryMap&& other) noexcept;
  MemoryMap& operator=(MemoryMap&& other) noexcept;
  MemoryMap(const MemoryMap&) = delete;
  MemoryMap& operator=(const MemoryMap&) = delete;

  std::span<const uint8_t> bytes() const { return {data_, size_}; }
  // Gives back the memory of pages that were read; they are read from the file again when they are used.
  void ReleasePages() const;
  // Copies bytes with a file read instead of through mapped pages: slower than bytes(), but takes no memory. Throws InputError.
  void ReadAt(size_t offset, std::span<uint8_t> to) const;

 private:
  const uint8_t* data_ = nullptr;
  size_t size_ = 0;
  int descriptor_ = -1;
  std::filesystem::path file_;
};

}  // namespace skyquilt::base
