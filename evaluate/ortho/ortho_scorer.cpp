#include "evaluate/ortho/ortho_scorer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "evaluate/ortho/compare_maps.h"
#include "evaluate/ortho/edge_targets.h"
#include "evaluate/ortho/moving_cars.h"
#include "surface/map_frame.h"

namespace skyquilt::evaluate::ortho {
namespace {

namespace fs = std::filesystem;

bool IsFile(const fs::path& file) {
  std::error_code ignored;
  return !file.empty() && fs::is_regular_file(file, ignored);
}

// Of ortho_sources.json.
struct Sources {
  int64_t cells = 0, field_cells = 0;
  std::vector<size_t> photos;  // in use, indices into Survey::photos
};

Sources ReadSources(const fs::path& file, const survey::Survey& survey) {
  std::map<std::string, size_t> photo_named;
  for (size_t i = 0; i < survey.photos.size(); ++i) photo_named[survey.photos[i].name] = i;
  Sources sources;
  try {
    const nlohmann::json json = base::ParseJson(base::ReadFile(file));
    sources.cells = json.at("cells").get<int64_t>();
    sources.field_cells = json.at("field_cells").get<int64_t>();
    for (const auto& [name, photo] : json.at("photos").items()) {
      const auto known = photo_named.find(name);
      if (photo.at("cells").get<int64_t>() > 0 && known != photo_named.end()) sources.photos.push_back(known->second);
    }
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", "Make it again with 'skyquilt render'");
  }
  return sources;
}

int64_t CountCells(const gis::MapReader& map) {
  constexpr int kRows = 64;
  int64_t cells = 0;
  for (int row = 0; row < map.grid().height; row += kRows) {
    const MapPart part = ReadPart(map, 0, row, map.grid().width, std::min(kRows, map.grid().height - row));
    cells += std::count(part.known.data.begin(), part.known.data.end(), 1);
  }
  return cells;
}

// The frame whose heights are those of the file.
skyquilt::surface::MapFrame FrameOf(const scene::SceneInfo& info, const fs::path& dsm) {
  const int undulations = IsFile(dsm) ? gis::ReadUndulations(dsm) : 0;
  return skyquilt::surface::MapFrame(
      info, undulations == 0 ? geo::Vertical::kAsTagged : (undulations > 0 ? geo::Vertical::kEllipsoid : geo::Vertical::kEgm96));
}

// Cells whose centres are inside the rectangle around the training cameras.
CellArea AreaBetweenCameras(const gis::MapGrid& grid, const survey::Survey& survey, const skyquilt::surface::MapFrame& frame) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e12), high = -low;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.is_test) continue;
    const Eigen::Vector2d place = frame.MapFromEnu(photo.cam_from_enu.OriginInSource()).head<2>();
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  const Eigen::Vector2d first = grid.CellOf({low.x(), high.y()}), last = grid.CellOf({high.x(), low.y()});
  const auto cell = [](double value, int n) { return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(n))); };
  return {cell(std::ceil(first.x()), grid.width), cell(std::ceil(first.y()), grid.height), cell(std::floor(last.x()) + 1.0, grid.width),
          cell(std::floor(last.y()) + 1.0, grid.height)};
}

struct OrthoInput {
  const survey::Survey& survey;
  const scene::SceneInfo& info;
  MapFiles files;
  fs::path dsm;
  std::optional<Sources> sources;
};

void TakeComparison(MapComparison comparison, OrthoResult* result) {
  OrthoScores& scores = result->scores;
  scores.psnr_db = skyquilt::metrics::PsnrOf(comparison.error);
  scores.cells_compared = comparison.error.n_values / 3;
  if (comparison.ssim_cells > 0) scores.ssim = comparison.ssim_sum / static_cast<double>(comparison.ssim_cells);
  scores.light_error_stops = comparison.light_error_stops;
  const SeamLevels levels = LevelsOf(comparison.seams);
  if (!comparison.seams.empty()) scores.seams = levels.pairs;
  scores.seam_levels = levels.mean;
  scores.seam_levels_worst = levels.worst;
  result->crops = std::move(comparison.crops);
}

void ScoreAgainstTruth(const OrthoInput& input, base::ThreadPool& threads, OrthoResult* result) {
  const survey::Truth& truth = *input.survey.truth;
  const std::vector<OpenMaps> maps = OpenForThreads(input.files, threads);
  const skyquilt::surface::MapFrame frame = FrameOf(input.info, input.dsm);
  std::optional<HeightMap> heights;
  if (IsFile(input.dsm)) heights.emplace(input.dsm);
  const CellArea area = AreaBetweenCameras(maps.front().map.grid(), input.survey, frame);
  OrthoScores& scores = result->scores;
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  if (!area.Empty()) {
    shift_m = MeasureShift(maps, area, threads);
    scores.shift_east_m = shift_m.x();
    scores.shift_north_m = shift_m.y();
    TakeComparison(CompareMaps(maps, area, shift_m, heights ? &*heights : nullptr, threads), result);
  }
  if (IsFile(truth.edge_targets_json)) {
    const EdgeSharpness sharpness =
        MeasureSharpness(ReadEdgeTargets(truth.edge_targets_json, input.survey.origin, shift_m), maps.front().map, input.survey, frame);
    scores.edge_targets = sharpness.targets;
    scores.mtf50_per_cell = sharpness.map_per_cell;
    scores.mtf50_per_m = sharpness.map_per_m;
    scores.photo_mtf50_per_px = sharpness.photo_per_px;
    scores.photo_mtf50_per_m = sharpness.photo_per_m;
  }
  std::error_code ignored;
  if (input.sources && heights && !truth.masks_folder.empty() && fs::is_directory(truth.masks_folder, ignored)) {
    const MovingCars cars = CountMovingCars(maps, shift_m, input.sources->photos, truth.masks_folder, input.survey, *heights, frame, threads);
    scores.moving_car_cells = cars.cells;
    if (cars.cells > 0) scores.moving_car_share = static_cast<double>(cars.differing) / static_cast<double>(cars.cells);
  }
}

void TakeSources(const OrthoInput& input, OrthoScores* scores) {
  const gis::MapReader map(input.files.map);
  scores->cell_m = map.grid().resolution_m;
  if (!input.sources) {
    scores->cells = CountCells(map);
    return;
  }
  scores->cells = input.sources->cells;
  scores->photos_in_use = static_cast<int64_t>(input.sources->photos.size());
  if (scores->cells <= 0) return;
  scores->share_field = static_cast<double>(input.sources->field_cells) / static_cast<double>(scores->cells);
  scores->share_photos = 1.0 - scores->share_field;
}

std::string PartsOf(const OrthoScores& scores) {
  std::string text = fmt::format("PSNR {:.2f} dB, SSIM {:.3f}", scores.psnr_db, scores.ssim);
  if (scores.shift_east_m != 0.0 || scores.shift_north_m != 0.0) {
    text += fmt::format(" after moving it back by {:.3f} m east and {:.3f} m north", scores.shift_east_m, scores.shift_north_m);
  }
  if (std::isfinite(scores.mtf50_per_cell)) {
    text += fmt::format(", MTF50 {:.3f} cycles per cell, {:.2f} per metre (a photo straight down has {:.3f} per pixel, {:.2f} per metre)",
                        scores.mtf50_per_cell, scores.mtf50_per_m, scores.photo_mtf50_per_px, scores.photo_mtf50_per_m);
  }
  if (std::isfinite(scores.seam_levels)) text += fmt::format(", seams {:.2f} of 255 (worst {:.2f})", scores.seam_levels, scores.seam_levels_worst);
  if (std::isfinite(scores.moving_car_share)) text += fmt::format(", {:.1f} % of cells under moving cars differ", 100.0 * scores.moving_car_share);
  return text;
}

}  // namespace

std::string OrthoSummary(const OrthoScores& scores) {
  if (std::isfinite(scores.psnr_db) || scores.cells_compared > 0) return "orthophoto against the true map: " + PartsOf(scores);
  std::string text = fmt::format("orthophoto: {:.1f} million cells of {:g} m", static_cast<double>(scores.cells) / 1e6, scores.cell_m);
  if (std::isfinite(scores.share_photos)) {
    text += fmt::format(", {:.1f} % from {} photos, the rest from the field", 100.0 * scores.share_photos, scores.photos_in_use);
  }
  return text;
}

std::optional<OrthoResult> ScoreOrtho(const fs::path& products_folder, const survey::Survey& survey, const scene::SceneInfo& info,
                                      base::ThreadPool& threads) {
  OrthoInput input{survey, info, {.map = products_folder / "orthophoto.tif", .truth = {}, .sources = {}}, products_folder / "dsm.tif", {}};
  if (!IsFile(input.files.map)) return std::nullopt;
  OrthoResult result;
  try {
    if (IsFile(products_folder / "ortho_sources.json")) input.sources = ReadSources(products_folder / "ortho_sources.json", survey);
    if (input.sources && IsFile(products_folder / "ortho_sources.tif")) input.files.sources = products_folder / "ortho_sources.tif";
    TakeSources(input, &result.scores);
  } catch (const base::InputError& error) {
    base::LogWarning("the orthophoto is not scored: {}", error.what());
    return std::nullopt;
  }
  if (survey.truth && IsFile(survey.truth->ortho_tif)) {
    try {
      input.files.truth = survey.truth->ortho_tif;
      ScoreAgainstTruth(input, threads, &result);
    } catch (const base::InputError& error) {
      base::LogWarning("the orthophoto is not wholly compared with the true map: {}", error.what());
    }
  }
  base::LogInfo(OrthoSummary(result.scores));
  return result;
}

}  // namespace skyquilt::evaluate::ortho
