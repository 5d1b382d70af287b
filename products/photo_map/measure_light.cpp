#include "products/photo_map/measure_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "core/survey/picture_colors.h"
#include "products/photo_map/node_views.h"
#include "products/photo_map/overlap_gains.h"

namespace skyquilt::products {
namespace {

constexpr size_t kLightPlaces = 60000;  // at which light is measured
constexpr size_t kLightViews = 6;       // of each of them
constexpr size_t kComparedViews = 4;
constexpr float kDarkestCompared = 0.004F;  // linear light that is compared: neither noise nor clipped
constexpr float kBrightestCompared = 0.8F;

// Linear light that can be compared; NaN otherwise.
Colors Comparable(const Colors& display) {
  Colors light{};
  for (size_t k = 0; k < 3; ++k) {
    const float value = survey::QuickLight(display[k]);
    light[k] = value > kDarkestCompared && value < kBrightestCompared ? value : std::numeric_limits<float>::quiet_NaN();
  }
  return light;
}

// Places at which light is measured: nodes in a regular pattern, in rows.
struct LightPlaces {
  std::vector<Eigen::Vector3d> enu, map;
};

LightPlaces PlacesForLight(const PhotoMapInput& input) {
  const MapNodes nodes = MapNodes::Of(input.grid);
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(nodes.photos.size()) / kLightPlaces))));
  LightPlaces places;
  for (int row = 0; row < nodes.rows; row += step) {
    for (int column = 0; column < nodes.columns; column += step) {
      const Eigen::Vector2d cell = NodeCell(column, row);
      const Eigen::Vector2d position = input.grid.CellCentre(cell.x(), cell.y());
      const double height_m = input.surface.HeightAt(position);
      if (!std::isfinite(height_m)) continue;
      const gis::MapProjection::VerticalLine line = input.projection.VerticalLineAt(position);
      places.enu.emplace_back(line.start_enu + (input.projection.start_height_m() - height_m) * line.down_enu);
      places.map.emplace_back(position.x(), position.y(), height_m);
    }
  }
  return places;
}

}  // namespace

PhotoLight MeasureLight(const PhotoMapInput& input, survey::PhotoPictures& small, base::ThreadPool& threads) {
  const ViewFinder finder(input);
  const LightPlaces places = PlacesForLight(input);
  const size_t photos = input.survey.photos.size();
  constexpr size_t kPerTask = 512;
  const size_t tasks = (places.enu.size() + kPerTask - 1) / kPerTask;
  std::vector<std::vector<LightSample>> samples(tasks);
  std::vector<std::vector<OverlapRatio>> ratios(tasks);
  std::vector<int32_t> all;
  for (size_t i = 0; i < photos; ++i) {
    if (input.usable[i] != 0) all.push_back(static_cast<int32_t>(i));
  }
  base::Progress progress("light of the photos", static_cast<double>(tasks), "parts");
  threads.ParallelFor(static_cast<int64_t>(tasks), [&](int64_t task_index, int /*thread*/) {
    base::ThrowIfCancelled();
    const auto task = static_cast<size_t>(task_index);
    std::vector<NodeView> views;
    for (size_t i = task * kPerTask; i < std::min((task + 1) * kPerTask, places.enu.size()); ++i) {
      finder.Find(places.enu[i], places.map[i], all, kLightViews, &views);
      const std::optional<Colors> field = FieldColor(input, places.map[i].head<2>());
      const Colors wanted = field ? Comparable(*field) : Colors{};
      std::vector<std::pair<int32_t, Colors>> shown;
      for (const NodeView& view : views) {
        std::shared_ptr<const survey::PhotoPicture> held;
        const std::optional<Colors> color = SmallColor(input, small, view, &held);
        if (!color) continue;
        const Colors light = Comparable(*color);
        shown.emplace_back(view.photo, light);
        if (!field) continue;
        LightSample sample{view.photo, Radius2Of(input, view), {}};
        for (size_t k = 0; k < 3; ++k) sample.log_ratio[k] = std::log(wanted[k] / light[k]);
        samples[task].push_back(sample);
      }
      if (!input.field_rgba.empty()) continue;
      for (size_t a = 0; a < std::min(shown.size(), kComparedViews); ++a) {
        for (size_t b = a + 1; b < std::min(shown.size(), kComparedViews); ++b) {
          OverlapRatio ratio{shown[a].first, shown[b].first, {}};
          for (size_t k = 0; k < 3; ++k) ratio.log_ratio[k] = std::log(shown[a].second[k] / shown[b].second[k]);
          ratios[task].push_back(ratio);
        }
      }
    }
    progress.Advance();
  });
  progress.Finish();
  if (input.field_rgba.empty()) {
    std::vector<OverlapRatio> joined;
    for (const auto& part : ratios) joined.insert(joined.end(), part.begin(), part.end());
    PhotoLight light = PhotoLight::None(photos, input.survey.cameras.size());
    const std::vector<std::array<float, 3>> log_gains = GainsOfOverlaps(photos, joined);
    for (size_t i = 0; i < photos; ++i) {
      for (size_t k = 0; k < 3; ++k) light.gain[i][k] = std::exp(log_gains[i][k]);
    }
    return light;
  }
  std::vector<LightSample> joined;
  for (const auto& part : samples) joined.insert(joined.end(), part.begin(), part.end());
  std::vector<int> camera_of_photo;
  for (const survey::Photo& photo : input.survey.photos) camera_of_photo.push_back(photo.camera);
  return FitLight(joined, camera_of_photo, input.survey.cameras.size());
}

}  // namespace skyquilt::products
