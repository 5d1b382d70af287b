// A file that keeps what long work has found out so far, so that the work continues from there after it was killed. Written atomically; a file that
// belongs to other work, comes from another version of the program or is damaged is removed and not used: the work then begins anew.
// Content: kMagic, format version, key, what the caller packed, XXH64 digest of all before it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "core/base/packed_bytes.h"

namespace skyquilt::evaluate {

class ProgressFile {
 public:
  static constexpr std::string_view kMagic = "skyquilt evaluate progress\n";
  // To be raised when other values are packed, or a score is computed in another way.
  static constexpr uint32_t kVersion = 1;

  // key: names whatever the content depends on.
  ProgressFile(std::filesystem::path file, std::string key);

  // Whether the file exists, belongs to this work and `load` has read its content to the end. If it exists and cannot be used (load may throw
  // base::UnreadableBytes too), a line of the log says why, and it is removed. Throws nothing else than load does.
  bool Read(const std::function<void(base::ByteUnpacker*)>& load) const;
  // Packs what `save` adds and replaces the file; returns its size. expected_bytes: about its size, 0 when unknown. Throws base::InputError.
  size_t Write(size_t expected_bytes, const std::function<void(base::BytePacker*)>& save) const;
  void Remove() const;

 private:
  std::filesystem::path file_;
  std::string key_;
};

}  // namespace skyquilt::evaluate
