#include "products/photo_map/paint_job.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/packed_bytes.h"

namespace skyquilt::products {
namespace {

namespace fs = std::filesystem;

constexpr size_t kJobHashDigits = 16;

// 0: not there.
uint64_t SizeOf(const fs::path& file) {
  std::error_code error;
  const uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

// Of all photos and their masks. Not their times, which machines may see differently.
std::vector<uint64_t> PhotoSizes(const survey::Survey& survey) {
  std::vector<uint64_t> sizes;
  for (const survey::Photo& photo : survey.photos) {
    sizes.push_back(SizeOf(survey.photo_root / photo.name));
    sizes.push_back(photo.mask.empty() ? 0 : SizeOf(photo.mask));
  }
  return sizes;
}

void PackGrid(const gis::MapGrid& grid, base::BytePacker* bytes) {
  bytes->Add(static_cast<uint8_t>(grid.georeferenced ? 1 : 0));
  bytes->Add(grid.zone.zone);
  bytes->Add(static_cast<uint8_t>(grid.zone.north ? 1 : 0));
  bytes->Add(grid.left);
  bytes->Add(grid.top);
  bytes->Add(grid.resolution_m);
  bytes->Add(grid.width);
  bytes->Add(grid.height);
}

gis::MapGrid UnpackGrid(base::ByteUnpacker* bytes) {
  gis::MapGrid grid;
  bytes->Take(&grid.georeferenced);
  bytes->Take(&grid.zone.zone);
  bytes->Take(&grid.zone.north);
  bytes->Take(&grid.left);
  bytes->Take(&grid.top);
  bytes->Take(&grid.resolution_m);
  bytes->Take(&grid.width);
  bytes->Take(&grid.height);
  return grid;
}

}  // namespace

struct PaintJob::Data {
  survey::Survey survey;
  std::vector<char> usable;
  gis::MapGrid grid;
  geo::Geodetic origin;
  std::vector<uint8_t> field_rgba;
  std::unique_ptr<gis::MapProjection> projection;
  std::unique_ptr<HeightGrid> surface;
  std::vector<float> slack_m;
};

void WritePaintJob(const PhotoMapInput& input, const geo::Geodetic& origin, const PhotoMap& map, const fs::path& file) {
  base::BytePacker bytes;
  bytes.Reserve(8 * input.surface.grid().size() + 17 * map.nodes().photos.size() + (size_t{1} << 20));
  bytes.Add(PhotoSizes(input.survey));
  bytes.Add(origin);
  PackGrid(input.grid, &bytes);
  PackGrid(input.surface.grid(), &bytes);
  bytes.Add(input.surface.heights());
  bytes.Add(std::vector<uint8_t>(input.field_rgba.begin(), input.field_rgba.end()));
  bytes.Add(std::vector<char>(input.usable.begin(), input.usable.end()));
  bytes.Add(input.ground_z);
  bytes.Add(input.flown_height_m);
  bytes.Add(input.shading.grid.columns);
  bytes.Add(input.shading.grid.rows);
  bytes.Add(input.shading.log_shading);
  bytes.Add(map.light().gain);
  bytes.Add(map.light().falloff);
  bytes.Add(map.nodes().columns);
  bytes.Add(map.nodes().rows);
  bytes.Add(map.nodes().photos);
  bytes.Add(map.nodes().seen);
  base::WriteFileAtomically(file, base::HashHex(bytes.bytes()) + bytes.bytes());
}

PaintJob::PaintJob(survey::Survey survey, const fs::path& file, size_t picture_bytes, base::ThreadPool& threads) : data_(std::make_unique<Data>()) {
  data_->survey = std::move(survey);
  const std::string content = base::ReadFile(file);
  const std::string_view all = content;
  if (all.size() < kJobHashDigits || base::HashHex(all.substr(kJobHashDigits)) != all.substr(0, kJobHashDigits)) {
    throw base::InputError(file, "is damaged", "All machines must see the same files of the project; then run the same command again");
  }
  base::ByteUnpacker bytes(all.substr(kJobHashDigits), file.string() + " ends too early");
  if (bytes.Take<std::vector<uint64_t>>() != PhotoSizes(data_->survey)) {
    throw base::InputError(data_->survey.photo_root, "has other photos, or other masks, than the first rank sees",
                           "All machines must see the same photos under the same path");
  }
  bytes.Take(&data_->origin);
  data_->grid = UnpackGrid(&bytes);
  const gis::MapGrid surface_grid = UnpackGrid(&bytes);
  data_->surface = std::make_unique<HeightGrid>(surface_grid, bytes.Take<std::vector<float>>());
  bytes.Take(&data_->field_rgba);
  bytes.Take(&data_->usable);
  data_->projection = std::make_unique<gis::MapProjection>(data_->origin, data_->grid);
  data_->slack_m = SightSlack(*data_->surface, threads);
  PhotoMapInput input{.survey = data_->survey,
                      .usable = data_->usable,
                      .grid = data_->grid,
                      .projection = *data_->projection,
                      .surface = *data_->surface,
                      .slack_m = data_->slack_m,
                      .field_rgba = data_->field_rgba,
                      .picture_bytes = picture_bytes};
  bytes.Take(&input.ground_z);
  bytes.Take(&input.flown_height_m);
  bytes.Take(&input.shading.grid.columns);
  bytes.Take(&input.shading.grid.rows);
  bytes.Take(&input.shading.log_shading);
  PhotoLight light;
  bytes.Take(&light.gain);
  bytes.Take(&light.falloff);
  MapNodes nodes;
  bytes.Take(&nodes.columns);
  bytes.Take(&nodes.rows);
  bytes.Take(&nodes.photos);
  bytes.Take(&nodes.seen);
  bytes.End();
  map_ = std::make_unique<PhotoMap>(input, std::move(light), std::move(nodes));
}

PaintJob::~PaintJob() = default;

const gis::MapGrid& PaintJob::grid() const {
  return data_->grid;
}

}  // namespace skyquilt::products
