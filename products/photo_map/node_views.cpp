#include "products/photo_map/node_views.h"

#include <algorithm>
#include <cmath>

#include "core/survey/picture_colors.h"
#include "products/photo_map/photo_choice.h"

namespace skyquilt::products {
namespace {

constexpr double kRimShare = 0.08;  // of the shorter side of a photo, where it gives way to others
constexpr double kRimCost = 0.02;
constexpr double kFlattestTangent2 = kMostOblique;

}  // namespace

ViewFinder::ViewFinder(const PhotoMapInput& input) : input_(input), eyes_map_(EyesOnMap(input.survey, input.projection)) {
  eyes_enu_.reserve(input.survey.photos.size());
  for (const survey::Photo& photo : input.survey.photos) eyes_enu_.push_back(photo.cam_from_enu.OriginInSource());
}

std::vector<int32_t> ViewFinder::Around(const Eigen::Vector3d& centre_enu, double radius_m) const {
  std::vector<int32_t> photos;
  for (size_t i = 0; i < eyes_enu_.size(); ++i) {
    if (input_.usable[i] == 0) continue;
    const Eigen::Vector3d to_eye = eyes_enu_[i] - centre_enu;
    const double reach_m = std::sqrt(kFlattestTangent2) * (std::max(to_eye.z(), 0.0) + radius_m) + radius_m;
    if (to_eye.head<2>().squaredNorm() <= reach_m * reach_m) photos.push_back(static_cast<int32_t>(i));
  }
  return photos;
}

int ViewFinder::Find(const Eigen::Vector3d& place_enu, const Eigen::Vector3d& place_map, std::span<const int32_t> photos, size_t most,
                     std::vector<NodeView>* views) const {
  std::vector<NodeView> ranked;
  for (const int32_t photo : photos) {
    const double cost = ViewCost(place_enu, eyes_enu_[static_cast<size_t>(photo)], input_.flown_height_m);
    if (std::isfinite(cost)) ranked.push_back({cost, photo, {}});
  }
  std::sort(ranked.begin(), ranked.end(),
            [](const NodeView& a, const NodeView& b) { return a.cost < b.cost || (a.cost == b.cost && a.photo < b.photo); });
  views->clear();
  std::vector<NodeView> hidden;
  const double slack_m = SlackAt(place_map);
  int in_frame = 0;
  for (NodeView& view : ranked) {
    if (views->size() == most && in_frame >= kMostSeen) break;
    const survey::Photo& photo = input_.survey.photos[static_cast<size_t>(view.photo)];
    const camera::Camera& camera = input_.survey.cameras[static_cast<size_t>(photo.camera)];
    const std::optional<Eigen::Vector2d> pixel = survey::PixelIn(camera, photo.cam_from_enu, place_enu);
    if (!pixel) continue;
    in_frame = std::min(in_frame + 1, kMostSeen);
    if (views->size() == most) continue;
    const double width = camera.width, height = camera.height;
    const double inside = std::min({pixel->x(), pixel->y(), width - pixel->x(), height - pixel->y()}) / (kRimShare * std::min(width, height));
    if (inside < 1.0) view.cost += kRimCost * (1.0 / std::max(inside, 1e-3) - 1.0);
    view.pixel = *pixel;
    const bool visible = input_.surface.IsVisible(place_map, eyes_map_[static_cast<size_t>(view.photo)], slack_m);
    (visible ? *views : hidden).push_back(view);
  }
  if (views->empty()) {
    hidden.resize(std::min(hidden.size(), most));
    *views = std::move(hidden);
  }
  return in_frame;
}

double ViewFinder::SlackAt(const Eigen::Vector3d& place_map) const {
  const gis::MapGrid& grid = input_.surface.grid();
  const Eigen::Vector2d cell = grid.CellOf(place_map.head<2>());
  const int column = std::clamp(static_cast<int>(std::lround(cell.x())), 0, grid.width - 1);
  const int row = std::clamp(static_cast<int>(std::lround(cell.y())), 0, grid.height - 1);
  return static_cast<double>(input_.slack_m[grid.Index(column, row)]);
}

std::optional<Colors> SmallColor(const PhotoMapInput& input, survey::PhotoPictures& small, const NodeView& view,
                                 std::shared_ptr<const survey::PhotoPicture>* held) {
  if (!*held) *held = small.Of(static_cast<size_t>(view.photo));
  if (!*held) return std::nullopt;
  const survey::PhotoPicture& picture = **held;
  const camera::Camera& camera = input.survey.cameras[static_cast<size_t>(input.survey.photos[static_cast<size_t>(view.photo)].camera)];
  const Eigen::Vector2d pixel(view.pixel.x() * picture.rgb.width / camera.width, view.pixel.y() * picture.rgb.height / camera.height);
  if (survey::IsMasked(picture, pixel)) return std::nullopt;
  return survey::LinearAt(picture, pixel);
}

float Radius2Of(const PhotoMapInput& input, const NodeView& view) {
  return survey::Radius2(input.survey.cameras[static_cast<size_t>(input.survey.photos[static_cast<size_t>(view.photo)].camera)], view.pixel);
}

std::optional<Colors> FieldColor(const PhotoMapInput& input, const Eigen::Vector2d& easting_northing) {
  if (input.field_rgba.empty()) return std::nullopt;
  const gis::MapGrid& grid = input.surface.grid();
  const Eigen::Vector2d cell = grid.CellOf(easting_northing);
  const int column = static_cast<int>(std::floor(cell.x())), row = static_cast<int>(std::floor(cell.y()));
  Colors sum{};
  int n = 0;
  for (int y = row; y <= row + 1; ++y) {
    for (int x = column; x <= column + 1; ++x) {
      if (x < 0 || y < 0 || x >= grid.width || y >= grid.height) continue;
      const uint8_t* rgba = input.field_rgba.data() + 4 * grid.Index(x, y);
      if (rgba[3] == 0) return std::nullopt;
      for (size_t k = 0; k < 3; ++k) sum[k] += static_cast<float>(rgba[k]) / 255.0F;
      ++n;
    }
  }
  if (n == 0) return std::nullopt;
  for (float& value : sum) value /= static_cast<float>(n);
  return sum;
}

}  // namespace skyquilt::products
