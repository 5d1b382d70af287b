#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/page/figure.h"
#include "evaluate/control/tag_positions.h"
#include "evaluate/measured.h"
#include "evaluate/page/drawn_map.h"
#include "evaluate/page/geo_section.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

namespace {

using Tags = std::vector<std::optional<control::TagPosition>>;

constexpr double kMaxArrowShare = 0.15;  // of the map's longer side, for exaggerated arrows
constexpr std::array<double, 6> kExaggerations = {2.0, 5.0, 10.0, 20.0, 50.0, 100.0};

// Bounds of cameras and of the tags that are used, which are drawn `exaggeration` times too far from them: one wrong tag would make the rest of the
// map tiny.
DrawnMap FrameOf(const survey::Survey& survey, const Tags& tags, double exaggeration) {
  MapBounds bounds;
  for (size_t i = 0; i < tags.size(); ++i) {
    const Eigen::Vector3d center = survey.photos[i].cam_from_enu.OriginInSource();
    bounds.Include(center.head<2>());
    if (tags[i] && survey.photos[i].gps_inlier) bounds.Include((center + exaggeration * (tags[i]->recorded - center)).head<2>());
  }
  bounds.MakeRoom();
  return DrawnMap(bounds);
}

// How many times too far from their photos the tags are drawn, so that the arrows can be seen but do not cover their neighbours.
double Exaggeration(const survey::Survey& survey, const Tags& tags) {
  const DrawnMap frame = FrameOf(survey, tags, 1.0);
  std::vector<double> lengths_px;
  for (size_t i = 0; i < tags.size(); ++i) {
    if (!tags[i] || !survey.photos[i].gps_inlier) continue;
    lengths_px.push_back(frame.scale() * (tags[i]->recorded - survey.photos[i].cam_from_enu.OriginInSource()).head<2>().norm());
  }
  const double median_px = MedianOfMeasured(lengths_px);
  if (!(median_px > 0.0)) return 1.0;
  const double spacing_px = std::sqrt(frame.width_px() * frame.height_px() / static_cast<double>(survey.photos.size()));
  const double wanted_px = std::clamp(0.25 * spacing_px, 6.0, 24.0);
  const double allowed_px = kMaxArrowShare * std::max(frame.width_px(), frame.height_px());
  const double longest_px = *std::max_element(lengths_px.begin(), lengths_px.end());
  double factor = 1.0;
  for (const double next : kExaggerations) {
    if (median_px * factor >= wanted_px || longest_px * next > allowed_px) break;
    factor = next;
  }
  return factor;
}

// Share of the way from a point inside the map to `end_px` that stays inside.
double ShareInside(const DrawnMap& frame, const Eigen::Vector2d& start_px, const Eigen::Vector2d& end_px) {
  const Eigen::Vector2d size(frame.width_px(), frame.height_px());
  double share = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double step = end_px[axis] - start_px[axis];
    if (end_px[axis] > size[axis]) share = std::min(share, (size[axis] - start_px[axis]) / step);
    if (end_px[axis] < 0.0) share = std::min(share, -start_px[axis] / step);
  }
  return share;
}

class GeoMapDrawing {
 public:
  explicit GeoMapDrawing(const survey::Survey& survey)
      : survey_(survey),
        tags_(control::TagPositions(survey)),
        exaggeration_(Exaggeration(survey, tags_)),
        frame_(FrameOf(survey, tags_, exaggeration_)) {
    const size_t n = survey.photos.size();
    radius_px_ = n > 800 ? 1.4 : n > 200 ? 2.0 : 2.8;
  }

  bool HasTags() const {
    return std::any_of(tags_.begin(), tags_.end(), [](const auto& tag) { return tag.has_value(); });
  }

  std::string Figure() const {
    return MapFigureBegin(frame_, survey_.photos.size() > 800 ? "geo-map many" : "geo-map", "Map of camera positions and GPS tags") + Tracks() +
           Arrows(true) + Arrows(false) + Untagged() + ScaleBarAndNorth(frame_, true) + End();
  }

 private:
  Eigen::Vector2d CameraPixel(size_t i) const { return frame_.Pixel(survey_.photos[i].cam_from_enu.OriginInSource()); }
  Eigen::Vector2d TagPixel(size_t i) const {
    const Eigen::Vector2d camera_px = CameraPixel(i);
    return camera_px + exaggeration_ * (frame_.Pixel(tags_[i]->recorded) - camera_px);
  }
  bool Inside(const Eigen::Vector2d& x_px) const {
    return x_px.x() >= 0.0 && x_px.y() >= 0.0 && x_px.x() <= frame_.width_px() && x_px.y() <= frame_.height_px();
  }

  std::string Tracks() const {
    std::string svg;
    for (const auto& [flight, photos] : control::PhotosByFlight(survey_)) {
      std::vector<Eigen::Vector2d> cameras_px, tags_px;
      for (const size_t i : photos) {
        cameras_px.push_back(CameraPixel(i));
        // Tags far away are shown by their arrows alone.
        if (tags_[i] && Inside(TagPixel(i))) tags_px.push_back(TagPixel(i));
      }
      svg += TrackLine("tags", tags_px, fmt::format("GPS tags of flight {}", flight + 1));
      svg += TrackLine("cameras", cameras_px, fmt::format("Fitted camera positions of flight {}", flight + 1));
    }
    return svg;
  }

  std::string Title(size_t i) const {
    const survey::Photo& photo = survey_.photos[i];
    const Eigen::Vector3d& residual = tags_[i]->residual;
    std::string title = fmt::format("{}, flight {}{}\nresidual east {}, north {}, up {}", EscapeHtml(photo.name), photo.flight + 1,
                                    photo.gps_inlier ? "" : ", tag not used", FormatFixed(residual.x(), 2), FormatFixed(residual.y(), 2),
                                    FormatFixed(residual.z(), 2, "m"));
    if (survey_.fit.tag_lag_s == 0.0) return title;
    return title + fmt::format("\nmoved by {} for a lag of {}", FormatFixed(photo.gps_correction_m.head<2>().norm(), 1, "m"),
                               FormatFixed(survey_.fit.tag_lag_s, 2, "s"));
  }

  std::string Arrows(bool used) const {
    std::string svg;
    for (size_t i = 0; i < tags_.size(); ++i) {
      if (!tags_[i] || survey_.photos[i].gps_inlier != used) continue;
      const Eigen::Vector2d start_px = CameraPixel(i);
      const Eigen::Vector2d way_px = TagPixel(i) - start_px;
      const double share = ShareInside(frame_, start_px, start_px + way_px);
      svg += fmt::format("<g class=\"{}\"><title>{}</title><path{} d=\"{}\"/><circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/></g>",
                         used ? "used" : "unused", Title(i), share < 1.0 ? " class=\"beyond\"" : "", ArrowPath(start_px, start_px + share * way_px),
                         start_px.x(), start_px.y(), radius_px_);
    }
    return svg;
  }

  std::string Untagged() const {
    std::string svg;
    for (size_t i = 0; i < tags_.size(); ++i) {
      if (tags_[i]) continue;
      const Eigen::Vector2d x_px = CameraPixel(i);
      svg += fmt::format("<circle class=\"untagged\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}, no GPS tag</title></circle>", x_px.x(), x_px.y(),
                         radius_px_, EscapeHtml(survey_.photos[i].name));
    }
    return svg;
  }

  bool AnyPhoto(bool tagged, bool used) const {
    for (size_t i = 0; i < tags_.size(); ++i) {
      if (tags_[i].has_value() == tagged && (!tagged || survey_.photos[i].gps_inlier == used)) return true;
    }
    return false;
  }

  std::string End() const {
    std::string legend = LegendEntry("c1", "fitted camera positions") + LegendEntry("dashes", "GPS tags as recorded");
    if (AnyPhoto(true, true)) legend += LegendEntry("c0", "from a fitted position to its tag");
    if (AnyPhoto(true, false)) legend += LegendEntry("c5", "to a tag that is not used");
    if (AnyPhoto(false, false)) legend += LegendEntry("c1 ring", "photo without a tag");
    std::string text = "Tags are drawn as recorded, before any correction";
    if (exaggeration_ > 1.0) text += fmt::format(", and <b>{:.0f} times too far</b> from the fitted positions", exaggeration_);
    return MapFigureEnd(legend, text + ". Dashed arrows lead beyond the map. Where arrows point back along the track on all lines, the tags lag.");
  }

  const survey::Survey& survey_;
  Tags tags_;
  double exaggeration_;
  DrawnMap frame_;
  double radius_px_ = 2.8;
};

}  // namespace

std::string GeoMap(const survey::Survey& survey) {
  const GeoMapDrawing drawing(survey);
  return drawing.HasTags() ? drawing.Figure() : "";
}

}  // namespace skyquilt::evaluate::page
