#include "evaluate/page/drawn_map.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr double kMapWidth_px = 900.0;
constexpr double kMaxHeight_px = 820.0;
// Width over height: a flight along one line needs some room too, and the page is wider than high.
constexpr double kMinAspect = 1.3, kMaxAspect = 3.0;

}  // namespace

void MapBounds::Include(const Eigen::Vector2d& x) {
  if (!x.allFinite()) return;
  low = low.cwiseMin(x);
  high = high.cwiseMax(x);
}

void MapBounds::MakeRoom() {
  if (Empty()) return;
  const Eigen::Vector2d middle = 0.5 * (low + high);
  const Eigen::Vector2d half = 0.5 * (high - low);
  const Eigen::Vector2d room(std::max(half.x(), kMinAspect * half.y()), std::max(half.y(), half.x() / kMaxAspect));
  Include(middle - room);
  Include(middle + room);
}

DrawnMap::DrawnMap(const MapBounds& bounds) {
  Eigen::Vector2d low(-1.0, -1.0), high(1.0, 1.0);
  if (!bounds.Empty()) {
    low = bounds.low;
    high = bounds.high;
  }
  const double pad = 0.04 * std::max((high - low).maxCoeff(), 1.0);
  low.array() -= pad;
  high.array() += pad;
  const Eigen::Vector2d size = high - low;
  scale_ = std::min(kMapWidth_px / size.x(), kMaxHeight_px / size.y());
  width_px_ = size.x() * scale_;
  height_px_ = size.y() * scale_;
  west_ = low.x();
  north_ = high.y();
}

std::string MapFigureBegin(const DrawnMap& map, const std::string& css_class, const char* spoken) {
  return fmt::format("<figure class=\"card map-card\"><svg class=\"map {}\" viewBox=\"0 0 {:.1f} {:.1f}\" role=\"img\" aria-label=\"{}\">", css_class,
                     map.width_px(), map.height_px(), spoken);
}

std::string MapFigureEnd(const std::string& legend, const std::string& note) {
  return fmt::format("</svg><figcaption><div class=\"legend\">{}</div>{}</figcaption></figure>\n", legend, note.empty() ? "" : Note(note));
}

std::string BackgroundImage(const DrawnMap& map, const MapBackground& background, const char* css_class) {
  return fmt::format("<image {}href=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\"/>",
                     *css_class == '\0' ? "" : fmt::format("class=\"{}\" ", css_class), EscapeHtml(background.image), map.X(background.min_enu.x()),
                     map.Y(background.max_enu.y()), (background.max_enu.x() - background.min_enu.x()) * map.scale(),
                     (background.max_enu.y() - background.min_enu.y()) * map.scale());
}

std::string TrackLine(const char* css_class, const std::vector<Eigen::Vector2d>& points_px, const std::string& title) {
  std::string points;
  for (const Eigen::Vector2d& x_px : points_px) points += fmt::format("{:.1f},{:.1f} ", x_px.x(), x_px.y());
  return fmt::format("<polyline class=\"{}\" points=\"{}\"><title>{}</title></polyline>", css_class, points, title);
}

std::string ScaleBarAndNorth(const DrawnMap& frame, bool georeferenced) {
  // The largest length 1, 2 or 5 times a power of ten that fits into a quarter of the map.
  const double room_m = 0.25 * frame.width_px() / frame.scale();
  const double magnitude = std::pow(10.0, std::floor(std::log10(room_m)));
  const double length_m = magnitude * (5.0 * magnitude <= room_m ? 5.0 : 2.0 * magnitude <= room_m ? 2.0 : 1.0);
  const std::string label = !georeferenced       ? fmt::format("{:g} units (scale unknown)", length_m)
                            : length_m >= 1000.0 ? fmt::format("{:g} km", length_m / 1000.0)
                                                 : fmt::format("{:g} m", length_m);
  const double x = 18.0, y = frame.height_px() - 20.0;
  std::string svg = fmt::format("<g class=\"scale\"><path d=\"M{0:.1f} {1:.1f}v6h{2:.1f}v-6\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\">{4}</text></g>", x,
                                y, length_m * frame.scale(), y - 5.0, label);
  if (georeferenced) {
    svg += fmt::format("<g class=\"north\" transform=\"translate({:.1f} 30)\"><path d=\"M0 -16L7 8L0 3L-7 8Z\"/><text y=\"22\">N</text></g>",
                       frame.width_px() - 26.0);
  }
  return svg;
}

std::string ArrowPath(const Eigen::Vector2d& start_px, const Eigen::Vector2d& end_px) {
  std::string path = fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", start_px.x(), start_px.y(), end_px.x(), end_px.y());
  const Eigen::Vector2d way = end_px - start_px;
  const double length_px = way.norm();
  if (length_px < 4.0) return path;
  const Eigen::Vector2d along = way / length_px * std::min(6.0, 0.4 * length_px);
  const Eigen::Vector2d across(-0.5 * along.y(), 0.5 * along.x());
  const Eigen::Vector2d left = end_px - along + across, right = end_px - along - across;
  return path + fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}", left.x(), left.y(), end_px.x(), end_px.y(), right.x(), right.y());
}

}  // namespace skyquilt::evaluate::page
