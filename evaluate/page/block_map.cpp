#include <fmt/core.h>

#include <cmath>
#include <map>

#include "evaluate/control/tag_positions.h"
#include "evaluate/page/drawn_map.h"
#include "evaluate/page/page_parts.h"
#include "evaluate/page/sections.h"

namespace skyquilt::evaluate::page {

namespace {

// Bounds of blocks and cameras. GPS tags do not count, because one wrong tag would make the rest of the map tiny.
DrawnMap FrameOf(const ReportInput& input) {
  MapBounds bounds;
  for (const partition::Block& block : input.blocks->blocks) {
    bounds.Include(block.TrainMin().head<2>());
    bounds.Include(block.TrainMax().head<2>());
  }
  for (const survey::Photo& photo : input.survey->photos) bounds.Include(photo.cam_from_enu.OriginInSource().head<2>());
  return DrawnMap(bounds);
}

std::string Rect(const DrawnMap& frame, const Eigen::Vector3d& low, const Eigen::Vector3d& high, const char* css_class) {
  return fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", css_class, frame.X(low.x()),
                     frame.Y(high.y()), (high.x() - low.x()) * frame.scale(), (high.y() - low.y()) * frame.scale());
}

std::string HeldOutPsnr(const ReportInput& input, const partition::Block& block) {
  const metrics::BlockScore* score = input.metrics->FindBlock(block.name);
  return FormatFixed(score == nullptr ? kNotMeasured : score->psnr_db, 2, "dB");
}

std::string Blocks(const ReportInput& input, const DrawnMap& frame) {
  std::string svg = "<g class=\"layer-blocks\">";
  for (const partition::Block& block : input.blocks->blocks) {
    const scene::FieldTraining* log = input.training->Find(block.name);
    const bool failed = log != nullptr && !log->ok;
    const bool context = log != nullptr && log->shows_context;
    const std::string value = block.empty ? "empty" : failed ? "failed" : HeldOutPsnr(input, block) + (context ? ", shows the context" : "");
    svg += "<g>";
    if (!block.empty) svg += Rect(frame, block.TrainMin(), block.TrainMax(), "margin");
    svg += Rect(frame, block.min_enu, block.max_enu, block.empty ? "block empty" : failed ? "block failed" : "block");
    svg += fmt::format("<title>Block {}: {:.1f} m x {:.1f} m, heights {:.1f} to {:.1f} m, margin {:.1f} m, {}</title></g>", EscapeHtml(block.name),
                       block.max_enu.x() - block.min_enu.x(), block.max_enu.y() - block.min_enu.y(), block.min_enu.z(), block.max_enu.z(),
                       block.margin_m, value);
  }
  return svg + "</g>";
}

std::string BlockLabels(const ReportInput& input, const DrawnMap& frame) {
  std::string svg = "<g class=\"layer-blocks\">";
  for (const partition::Block& block : input.blocks->blocks) {
    const double width_px = (block.max_enu.x() - block.min_enu.x()) * frame.scale();
    if (width_px < 28.0) continue;  // the text would overlap its neighbours; the tooltip has the name
    const double x = frame.X(0.5 * (block.min_enu.x() + block.max_enu.x()));
    const double y = frame.Y(0.5 * (block.min_enu.y() + block.max_enu.y()));
    svg += fmt::format("<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x, y - 2.0, EscapeHtml(block.name));
    if (width_px < 70.0) continue;
    svg += fmt::format("<text class=\"value\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x, y + 16.0, block.empty ? "empty" : HeldOutPsnr(input, block));
  }
  return svg + "</g>";
}

// Tagged positions in the order of their times, one line per flight.
std::string GpsTracks(const ReportInput& input, const DrawnMap& frame) {
  const std::vector<std::optional<control::TagPosition>> tags = control::TagPositions(*input.survey);
  std::string svg = "<g class=\"layer-gps\">";
  for (const auto& [flight, photos] : control::PhotosByFlight(*input.survey)) {
    std::vector<Eigen::Vector2d> points_px;
    std::string marks;
    for (const size_t i : photos) {
      if (!tags[i]) continue;
      const Eigen::Vector2d& at = points_px.emplace_back(frame.Pixel(tags[i]->recorded));
      marks += fmt::format("M{:.1f} {:.1f}h6m-3 -3v6", at.x() - 3.0, at.y());
    }
    if (points_px.empty()) continue;
    svg += TrackLine("track", points_px, fmt::format("GPS tags of flight {}", flight + 1)) + "<path class=\"tag\" d=\"" + marks + "\"/>";
  }
  return svg + "</g>";
}

std::string Cameras(const ReportInput& input, const DrawnMap& frame) {
  std::map<int, size_t> scored;
  for (size_t i = 0; i < input.metrics->photos.size(); ++i) scored[input.metrics->photos[i].photo] = i;
  const double radius = input.survey->photos.size() > 800 ? 1.8 : input.survey->photos.size() > 200 ? 2.6 : 3.6;
  std::string training = "<g class=\"layer-cameras\">", test = "<g class=\"layer-tests\">";
  for (size_t i = 0; i < input.survey->photos.size(); ++i) {
    const survey::Photo& photo = input.survey->photos[i];
    const Eigen::Vector3d center = photo.cam_from_enu.OriginInSource();
    if (!center.allFinite()) continue;
    std::string title = EscapeHtml(photo.name);
    if (std::isfinite(photo.agl_m)) title += fmt::format(", {:.1f} m above ground", photo.agl_m);
    if (!photo.is_test) {
      training += fmt::format("<circle class=\"camera\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}</title></circle>", frame.X(center.x()),
                              frame.Y(center.y()), radius, title);
      continue;
    }
    const auto score = scored.find(static_cast<int>(i));
    const std::string mark = fmt::format("<circle class=\"camera test\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}, held out{}</title></circle>",
                                         frame.X(center.x()), frame.Y(center.y()), radius + 2.4, title,
                                         score == scored.end() ? "" : ", " + FormatFixed(input.metrics->photos[score->second].psnr_db, 2, "dB"));
    test += score == scored.end() ? mark : fmt::format("<a href=\"#photo-{}\">{}</a>", score->second, mark);
  }
  return training + "</g>" + test + "</g>";
}

}  // namespace

std::string BlockMapSvg(const ReportInput& input) {
  const DrawnMap frame = FrameOf(input);
  std::string svg =
      fmt::format("<svg id=\"map\" class=\"map{}\" viewBox=\"0 0 {:.1f} {:.1f}\" role=\"img\" aria-label=\"Map of blocks and cameras\">",
                  input.background ? " over-image" : "", frame.width_px(), frame.height_px());
  if (input.background) svg += BackgroundImage(frame, *input.background, "layer-ortho");
  svg += Blocks(input, frame) + GpsTracks(input, frame) + Cameras(input, frame) + BlockLabels(input, frame) +
         ScaleBarAndNorth(frame, input.survey->georeferenced);
  return svg + "</svg>\n";
}

}  // namespace skyquilt::evaluate::page
