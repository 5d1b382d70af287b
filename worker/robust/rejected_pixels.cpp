#include "worker/robust/rejected_pixels.h"

#include <algorithm>
#include <bit>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/packed_bytes.h"

namespace skyquilt::worker {
namespace {

constexpr size_t kHashDigits = 16;
constexpr const char* kHowToFix = "Remove it; the same command makes it again";

}  // namespace

void RejectedPixels::Set(size_t photo, int columns, int rows, const std::vector<uint8_t>& cells) {
  SKYQUILT_CHECK(cells.size() == static_cast<size_t>(columns) * static_cast<size_t>(rows), "one value per cell");
  Photo& p = photos_[photo];
  p = {.columns = columns, .rows = rows};
  if (std::ranges::all_of(cells, [](uint8_t cell) { return cell == 0; })) return;
  p.bits.assign((cells.size() + 7) / 8, 0);
  for (size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] != 0) p.bits[i / 8] = static_cast<uint8_t>(p.bits[i / 8] | 1U << (i % 8));
  }
}

bool RejectedPixels::At(size_t photo, int x, int y) const {
  if (photos_.empty()) return false;
  const Photo& p = photos_[photo];
  if (p.bits.empty()) return false;
  const size_t cell = static_cast<size_t>(y / cell_px_) * static_cast<size_t>(p.columns) + static_cast<size_t>(x / cell_px_);
  return (static_cast<unsigned>(p.bits[cell / 8]) >> (cell % 8) & 1U) != 0;
}

double RejectedPixels::Share(size_t photo) const {
  if (photos_.empty() || photos_[photo].bits.empty()) return 0.0;
  const Photo& p = photos_[photo];
  int64_t rejected = 0;
  for (const uint8_t bits : p.bits) rejected += std::popcount(bits);
  return static_cast<double>(rejected) / (static_cast<double>(p.columns) * p.rows);
}

void RejectedPixels::Save(const std::string& key, const std::filesystem::path& file) const {
  base::BytePacker bytes;
  bytes.Add(key);
  bytes.Add(cell_px_);
  bytes.AddCount(photos_.size());
  for (const Photo& photo : photos_) {
    bytes.Add(photo.columns);
    bytes.Add(photo.rows);
    bytes.Add(photo.bits);
  }
  base::WriteFileAtomically(file, base::HashHex(bytes.bytes()) + bytes.bytes());
}

RejectedPixels RejectedPixels::Load(const std::string& key, const std::filesystem::path& file) {
  const std::string content = base::ReadFile(file);
  const std::string_view all = content;
  if (all.size() < kHashDigits || base::HashHex(all.substr(kHashDigits)) != all.substr(0, kHashDigits)) {
    throw base::InputError(file, "is damaged", kHowToFix);
  }
  try {
    base::ByteUnpacker bytes(all.substr(kHashDigits), "ends too early");
    if (bytes.Take<std::string>() != key) throw base::InputError(file, "belongs to another training", kHowToFix);
    const int cell_px = bytes.Take<int>();
    if (cell_px < 1) bytes.Fail();
    RejectedPixels pixels(bytes.TakeCount(2 * sizeof(int)), cell_px);
    for (Photo& photo : pixels.photos_) {
      bytes.Take(&photo.columns);
      bytes.Take(&photo.rows);
      bytes.Take(&photo.bits);
      if (photo.columns < 0 || photo.rows < 0) bytes.Fail();
      if (!photo.bits.empty() && photo.bits.size() != (static_cast<size_t>(photo.columns) * static_cast<size_t>(photo.rows) + 7) / 8) bytes.Fail();
    }
    bytes.End();
    return pixels;
  } catch (const base::UnreadableBytes& error) {
    throw base::InputError(file, error.what(), kHowToFix);
  }
}

}  // namespace skyquilt::worker
