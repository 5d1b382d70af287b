// What the writers of all formats have in common. Nothing gets its final name before all files are complete.
#pragma once

#include <cstdint>
#include <span>
#include <string>
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

}  // namespace skyquilt::surface
