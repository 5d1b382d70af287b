// A checkerboard of tiles that divides a photo's pixels: what is fitted to the photo itself is fitted on one half of the tiles and scored on the
// other.
#pragma once

namespace skyquilt::evaluate::photos {

// Whether pixel (x, y), both >= 0, is in a tile that is fitted. tile_px: pixels per side of a tile. The tile at the upper left corner is fitted.
inline bool IsFittedTile(int x, int y, int tile_px = 16) {
  return (x / tile_px + y / tile_px) % 2 == 0;
}

}  // namespace skyquilt::evaluate::photos
