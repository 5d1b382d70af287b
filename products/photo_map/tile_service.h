// Interface between the orthophoto and what paints its tiles elsewhere: on other ranks.
#pragma once

#include <filesystem>
#include <functional>
#include <span>

#include "products/photo_map/photo_map.h"

namespace skyquilt::products {

class TileService {
 public:
  // Gets the cells of tiles[index].
  using Take = std::function<void(size_t index, PhotoMapRows cells)>;

  TileService() = default;
  virtual ~TileService() = default;
  TileService(const TileService&) = delete;
  TileService& operator=(const TileService&) = delete;

  // Paints tiles as PaintJob does, in any order; `take` is called by the thread that called this. job: file of a PaintJob. Tiles that nobody could
  // paint are left to the caller, with a warning that says why. Throws base::Interrupted and what `take` throws.
  virtual void Paint(const std::filesystem::path& job, std::span<const TileArea> tiles, const Take& take) = 0;
};

}  // namespace skyquilt::products
