#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/geo/enu_frame.h"
#include "core/page/html.h"
#include "evaluate/report_page.h"

namespace skyquilt::evaluate {

namespace {

constexpr double kMapWidth_px = 900.0;
constexpr double kMaxHeight_px = 820.0;

// Converts east and north in metres to pixels of the drawing, north up.
class MapFrame {
 public:
  MapFrame(Eigen::Vector2d low, Eigen::Vector2d high) {
    Eigen::Vector2d size = high - low;
    const double pad = 0.04 * std::max(size.maxCoeff(), 1.0);
    low.array() -= pad;
    high.array() += pad;
    size = high - low;
    scale_ = std::min(kMapWidth_px / size.x(), kMaxHeight_px / size.y());
    width_px_ = size.x() * scale_;
    height_px_ = size.y() * scale_;
    west_ = low.x();
    north_ = high.y();
  }
  double X(double east_m) const { return (east_m - west_) * scale_; }
  double Y(double north_m) const { return (north_ - north_m) * scale_; }
  double scale() const { return scale_; }
  double width_px() const { return width_px_; }
  double height_px() const { return height_px_; }

 private:
  double scale_ = 1.0, width_px_ = 1.0, height_px_ = 1.0, west_ = 0.0, north_ = 0.0;
};

void Grow(const Eigen::Vector2d& x, Eigen::Vector2d* low, Eigen::Vector2d* high) {
  if (!x.allFinite()) return;
  *low = low->cwiseMin(x);
  *high = high->cwiseMax(x);
}

// Bounds of blocks and cameras. GPS tags do not count, because one wrong tag would make the rest of the map tiny.
MapFrame FrameOf(const ReportInput& input) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const partition::Block& block : input.blocks->blocks) {
    Grow(block.TrainMin().head<2>(), &low, &high);
    Grow(block.TrainMax().head<2>(), &low, &high);
  }
  for (const survey::Photo& photo : input.survey->photos) Grow(photo.cam_from_enu.OriginInSource().head<2>(), &low, &high);
  if (!(high.array() >= low.array()).all()) return {Eigen::Vector2d(-1, -1), Eigen::Vector2d(1, 1)};
  return {low, high};
}

std::string Rect(const MapFrame& frame, const Eigen::Vector3d& low, const Eigen::Vector3d& high, const char* css_class) {
  return fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>", css_class, frame.X(low.x()),
                     frame.Y(high.y()), (high.x() - low.x()) * frame.scale(), (high.y() - low.y()) * frame.scale());
}

std::string HeldOutPsnr(const ReportInput& input, const partition::Block& block) {
  const BlockScore* score = input.metrics->FindBlock(block.name);
  return page::FormatFixed(score == nullptr ? kNotMeasured : score->psnr_db, 2, "dB");
}

std::string Blocks(const ReportInput& input, const MapFrame& frame) {
  std::string svg = "<g class=\"layer-blocks\">";
  for (const partition::Block& block : input.blocks->blocks) {
    const scene::FieldTraining* log = input.training->Find(block.name);
    const bool failed = log != nullptr && !log->ok;
    const std::string value = block.empty ? "empty" : failed ? "failed" : HeldOutPsnr(input, block);
    svg += "<g>";
    if (!block.empty) svg += Rect(frame, block.TrainMin(), block.TrainMax(), "margin");
    svg += Rect(frame, block.min_enu, block.max_enu, block.empty ? "block empty" : failed ? "block failed" : "block");
    svg += fmt::format("<title>Block {}: {:.1f} m x {:.1f} m, heights {:.1f} to {:.1f} m, margin {:.1f} m, {}</title></g>",
                       page::EscapeHtml(block.name), block.max_enu.x() - block.min_enu.x(), block.max_enu.y() - block.min_enu.y(), block.min_enu.z(),
                       block.max_enu.z(), block.margin_m, value);
  }
  return svg + "</g>";
}

std::string BlockLabels(const ReportInput& input, const MapFrame& frame) {
  std::string svg = "<g class=\"layer-blocks\">";
  for (const partition::Block& block : input.blocks->blocks) {
    const double width_px = (block.max_enu.x() - block.min_enu.x()) * frame.scale();
    if (width_px < 28.0) continue;  // the text would overlap its neighbours; the tooltip has the name
    const double x = frame.X(0.5 * (block.min_enu.x() + block.max_enu.x()));
    const double y = frame.Y(0.5 * (block.min_enu.y() + block.max_enu.y()));
    svg += fmt::format("<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x, y - 2.0, page::EscapeHtml(block.name));
    if (width_px < 70.0) continue;
    svg += fmt::format("<text class=\"value\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x, y + 16.0, block.empty ? "empty" : HeldOutPsnr(input, block));
  }
  return svg + "</g>";
}

// Tagged positions in photo order, one line per flight.
std::string GpsTracks(const ReportInput& input, const MapFrame& frame) {
  if (!input.survey->georeferenced || !geo::IsValid(input.survey->origin)) return "";
  const geo::EnuFrame enu(input.survey->origin);
  struct Tag {
    double time_s;
    Eigen::Vector3d x_in_enu;
  };
  std::map<int, std::vector<Tag>> flights;
  for (const survey::Photo& photo : input.survey->photos) {
    if (!photo.gps || !geo::IsValid(*photo.gps)) continue;
    flights[photo.flight].push_back({photo.time_s.value_or(0.0), enu.EnuFromGeodetic(*photo.gps)});
  }
  std::string svg = "<g class=\"layer-gps\">";
  for (auto& [flight, tags] : flights) {
    std::stable_sort(tags.begin(), tags.end(), [](const Tag& a, const Tag& b) { return a.time_s < b.time_s; });
    std::string line, marks;
    for (const Tag& tag : tags) {
      const double x = frame.X(tag.x_in_enu.x()), y = frame.Y(tag.x_in_enu.y());
      line += fmt::format("{:.1f},{:.1f} ", x, y);
      marks += fmt::format("M{:.1f} {:.1f}h6m-3 -3v6", x - 3.0, y);
    }
    svg += fmt::format("<polyline class=\"track\" points=\"{}\"><title>GPS tags of flight {}</title></polyline><path class=\"tag\" d=\"{}\"/>", line,
                       flight + 1, marks);
  }
  return svg + "</g>";
}

std::string Cameras(const ReportInput& input, const MapFrame& frame) {
  std::map<int, size_t> scored;
  for (size_t i = 0; i < input.metrics->photos.size(); ++i) scored[input.metrics->photos[i].photo] = i;
  const double radius = input.survey->photos.size() > 800 ? 1.8 : input.survey->photos.size() > 200 ? 2.6 : 3.6;
  std::string training = "<g class=\"layer-cameras\">", test = "<g class=\"layer-tests\">";
  for (size_t i = 0; i < input.survey->photos.size(); ++i) {
    const survey::Photo& photo = input.survey->photos[i];
    const Eigen::Vector3d center = photo.cam_from_enu.OriginInSource();
    if (!center.allFinite()) continue;
    std::string title = page::EscapeHtml(photo.name);
    if (std::isfinite(photo.agl_m)) title += fmt::format(", {:.1f} m above ground", photo.agl_m);
    if (!photo.is_test) {
      training += fmt::format("<circle class=\"camera\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}</title></circle>", frame.X(center.x()),
                              frame.Y(center.y()), radius, title);
      continue;
    }
    const auto score = scored.find(static_cast<int>(i));
    const std::string mark =
        fmt::format("<circle class=\"camera test\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"><title>{}, held out{}</title></circle>", frame.X(center.x()),
                    frame.Y(center.y()), radius + 2.4, title,
                    score == scored.end() ? "" : ", " + page::FormatFixed(input.metrics->photos[score->second].psnr_db, 2, "dB"));
    test += score == scored.end() ? mark : fmt::format("<a href=\"#photo-{}\">{}</a>", score->second, mark);
  }
  return training + "</g>" + test + "</g>";
}

std::string ScaleBarAndNorth(const ReportInput& input, const MapFrame& frame) {
  // The largest length 1, 2 or 5 times a power of ten that fits into a quarter of the map.
  const double room_m = 0.25 * frame.width_px() / frame.scale();
  const double magnitude = std::pow(10.0, std::floor(std::log10(room_m)));
  const double length_m = magnitude * (5.0 * magnitude <= room_m ? 5.0 : 2.0 * magnitude <= room_m ? 2.0 : 1.0);
  const std::string label = !input.survey->georeferenced ? fmt::format("{:g} units (scale unknown)", length_m)
                            : length_m >= 1000.0         ? fmt::format("{:g} km", length_m / 1000.0)
                                                         : fmt::format("{:g} m", length_m);
  const double x = 18.0, y = frame.height_px() - 20.0;
  std::string svg = fmt::format("<g class=\"scale\"><path d=\"M{0:.1f} {1:.1f}v6h{2:.1f}v-6\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\">{4}</text></g>", x,
                                y, length_m * frame.scale(), y - 5.0, label);
  if (input.survey->georeferenced) {
    svg += fmt::format("<g class=\"north\" transform=\"translate({:.1f} 30)\"><path d=\"M0 -16L7 8L0 3L-7 8Z\"/><text y=\"22\">N</text></g>",
                       frame.width_px() - 26.0);
  }
  return svg;
}

}  // namespace

std::string BlockMapSvg(const ReportInput& input) {
  const MapFrame frame = FrameOf(input);
  std::string svg =
      fmt::format("<svg id=\"map\" class=\"map{}\" viewBox=\"0 0 {:.1f} {:.1f}\" role=\"img\" aria-label=\"Map of blocks and cameras\">",
                  input.background ? " over-image" : "", frame.width_px(), frame.height_px());
  if (input.background) {
    const MapBackground& background = *input.background;
    svg += fmt::format(
        "<image class=\"layer-ortho\" href=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\"/>",
        page::EscapeHtml(background.image), frame.X(background.min_enu.x()), frame.Y(background.max_enu.y()),
        (background.max_enu.x() - background.min_enu.x()) * frame.scale(), (background.max_enu.y() - background.min_enu.y()) * frame.scale());
  }
  svg += Blocks(input, frame) + GpsTracks(input, frame) + Cameras(input, frame) + BlockLabels(input, frame) + ScaleBarAndNorth(input, frame);
  return svg + "</svg>\n";
}

}  // namespace skyquilt::evaluate
