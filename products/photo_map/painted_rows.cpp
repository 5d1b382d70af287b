#include "products/photo_map/painted_rows.h"

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/packed_bytes.h"

namespace skyquilt::products {
namespace {

namespace fs = std::filesystem;

constexpr int kPaintVersion = 1;  // changes when the same input is painted differently
constexpr size_t kHashDigits = 16;

// Size and time of a file, zero for one that is not there.
void AddFile(const fs::path& file, base::BytePacker* bytes) {
  std::error_code error;
  const uintmax_t size = fs::file_size(file, error);
  bytes->Add(static_cast<uint64_t>(error ? 0 : size));
  const fs::file_time_type time = fs::last_write_time(file, error);
  bytes->Add(static_cast<int64_t>(error ? 0 : time.time_since_epoch().count()));
}

template <typename T>
std::string HashOf(std::span<const T> values) {
  return base::HashHex({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

void AddGrid(const gis::MapGrid& grid, base::BytePacker* bytes) {
  bytes->Add(grid.left);
  bytes->Add(grid.top);
  bytes->Add(grid.resolution_m);
  bytes->Add(grid.width);
  bytes->Add(grid.height);
}

}  // namespace

std::string PaintKey(const PhotoMapInput& input) {
  base::BytePacker bytes;
  bytes.Add(kPaintVersion);
  AddGrid(input.grid, &bytes);
  AddGrid(input.surface.grid(), &bytes);
  bytes.Add(HashOf(std::span<const float>(input.surface.heights())));
  bytes.Add(HashOf(input.field_rgba));
  bytes.Add(HashOf(input.usable));
  bytes.Add(input.ground_z);
  if (input.shading.grid.On()) {
    bytes.Add(input.shading.grid.columns);
    bytes.Add(HashOf(std::span<const float>(input.shading.log_shading)));
  }
  for (const camera::Camera& camera : input.survey.cameras) {
    bytes.Add(camera.width);
    bytes.Add(camera.height);
    bytes.Add(camera.params);
  }
  for (const survey::Photo& photo : input.survey.photos) {
    bytes.Add(photo.name);
    bytes.Add(photo.camera);
    for (const double value : photo.cam_from_enu.rotation.coeffs()) bytes.Add(value);
    for (const double value : photo.cam_from_enu.translation) bytes.Add(value);
    AddFile(input.survey.photo_root / photo.name, &bytes);
    AddFile(photo.mask, &bytes);
  }
  return base::HashHex(bytes.bytes());
}

PaintedRows::PaintedRows(fs::path folder, const std::string& key) : folder_(std::move(folder)) {
  const fs::path key_file = folder_ / "key.txt";
  if (fs::exists(key_file) && base::ReadFile(key_file) == key + "\n") return;
  Remove();
  base::RequireWritableFolder(folder_);
  base::WriteFileAtomically(key_file, key + "\n");
}

fs::path PaintedRows::FileOf(int first_row) const {
  return folder_ / ("rows_" + std::to_string(first_row) + ".bin");
}

bool PaintedRows::Read(int first_row, size_t cells, PhotoMapRows* rows) const {
  const fs::path file = FileOf(first_row);
  if (!fs::exists(file)) return false;
  const std::string content = base::ReadFile(file);
  const std::string_view bytes = content;
  if (bytes.size() < kHashDigits || base::HashHex(bytes.substr(kHashDigits)) != bytes.substr(0, kHashDigits)) return false;
  base::ByteUnpacker unpacker(bytes.substr(kHashDigits), file.string() + " ends too early");
  unpacker.Take(&rows->rgba);
  unpacker.Take(&rows->sources);
  return rows->rgba.size() == 4 * cells && rows->sources.size() == cells;
}

void PaintedRows::Write(int first_row, const PhotoMapRows& rows) const {
  base::BytePacker bytes;
  bytes.Add(rows.rgba);
  bytes.Add(rows.sources);
  base::WriteFileAtomically(FileOf(first_row), base::HashHex(bytes.bytes()) + bytes.bytes());
}

bool PaintedRows::Stands(int first_row) const {
  return fs::exists(FileOf(first_row));
}

int PaintedRows::Count() const {
  int parts = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) parts += entry.path().extension() == ".bin" ? 1 : 0;
  return parts;
}

void PaintedRows::Remove() const {
  std::error_code error;
  fs::remove_all(folder_, error);
  if (error) throw base::InputError(folder_, "cannot be removed: " + error.message(), "Check the permissions of the folder");
}

}  // namespace skyquilt::products
