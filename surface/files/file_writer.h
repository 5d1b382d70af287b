// What the writers of all formats have in common. Nothing gets its final name before all files are complete.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "surface/files/file_tile.h"
#include "surface/written_file.h"

namespace skyquilt::surface {

// All functions throw base::InputError (disk full, no permission). A writer that was destroyed without Publish leaves nothing behind.
class FileWriter {
 public:
  FileWriter() = default;
  virtual ~FileWriter() = default;
  FileWriter(const FileWriter&) = delete;
  FileWriter& operator=(const FileWriter&) = delete;

  // A clean tile that is not empty. in_map: its vertices in coordinates of the maps; null for tiles above level 0.
  virtual void AddTile(const TexturedTile& /*tile*/, const MapVertices* /*in_map*/) {}
  // In coordinates of the maps.
  virtual void AddPoints(std::span<const CloudPoint> /*points*/) {}
  // Writes what is missing and waits until everything is on disk.
  virtual void Complete() = 0;
  // Gives the files their names.
  virtual void Publish() = 0;
  // A row of the table of what was made; none when nothing was added.
  virtual std::vector<WrittenFile> Rows() const = 0;
};

// "EPSG:32617 minus offset"; "local frame, metres".
std::string OffsetCrsName(const MapFrame& frame);

// Put and PutText append to a buffer in the byte order of all our formats, little endian.
static_assert(std::endian::native == std::endian::little, "files are written in the byte order of the machine");

template <typename T>
void Put(std::vector<uint8_t>* bytes, T value) {
  static_assert(std::is_arithmetic_v<T>);
  const auto* begin = reinterpret_cast<const uint8_t*>(&value);
  bytes->insert(bytes->end(), begin, begin + sizeof(T));
}

// Exactly `length` bytes: cut, or filled with zeros.
inline void PutText(std::vector<uint8_t>* bytes, std::string_view text, size_t length) {
  const std::string_view cut = text.substr(0, length);
  bytes->insert(bytes->end(), cut.begin(), cut.end());
  bytes->insert(bytes->end(), length - cut.size(), uint8_t{0});
}

inline std::span<const uint8_t> AsBytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

}  // namespace skyquilt::surface
