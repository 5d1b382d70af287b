#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "evaluate/page/building_numbers.h"
#include "evaluate/page/buildings_section.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {
namespace {

constexpr double kPlanWidth_px = 300.0, kPlanHeight_px = 210.0;
constexpr double kPlanPad_px = 34.0;  // room for the lengths
constexpr double kShortestLabelled_px = 30.0;

// The plan in pixels: the longer side of the shape across, u or v.
class PlanDrawing {
 public:
  PlanDrawing(const buildings::Building& building, const buildings::BuildingSet& set)
      : building_(building), scale_to_metres_(set.scale), unit_(BuildingUnits::Of(set).length) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : building.footprint.outer) box.extend(building.shape.FromEnu(corner));
    if (box.isEmpty()) return;
    const Eigen::Vector2d size = box.sizes().cwiseMax(1e-3);
    turned_ = size.y() > size.x();
    const Eigen::Vector2d shown = turned_ ? Eigen::Vector2d(size.y(), size.x()) : size;
    px_ = std::min((kPlanWidth_px - 2.0 * kPlanPad_px) / shown.x(), (kPlanHeight_px - 2.0 * kPlanPad_px) / shown.y());
    middle_uv_ = box.center();
    height_px_ = shown.y() * px_ + 2.0 * kPlanPad_px;
  }

  std::string Svg() const {
    if (!(px_ > 0.0)) return "";
    return fmt::format("<svg class=\"plan\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Plan of building {}\">", kPlanWidth_px,
                       height_px_, building_.id) +
           Walls() + Roofs() + Lengths() + North() + "</svg>";
  }

 private:
  // Of a place or a direction (origin: zero).
  Eigen::Vector2d Turned(const Eigen::Vector2d& uv) const { return turned_ ? Eigen::Vector2d(uv.y(), -uv.x()) : uv; }
  Eigen::Vector2d Pixel(const Eigen::Vector2d& uv) const {
    const Eigen::Vector2d xy = px_ * Turned(uv - middle_uv_);
    return {0.5 * kPlanWidth_px + xy.x(), 0.5 * height_px_ - xy.y()};
  }

  std::string Walls() const {
    std::string path;
    const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
      for (size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d at = Pixel(building_.shape.FromEnu(ring[i]));
        path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", at.x(), at.y());
      }
      path += "Z";
    };
    add(building_.footprint.outer);
    for (const std::vector<Eigen::Vector2d>& hole : building_.footprint.holes) add(hole);
    return fmt::format("<path class=\"walls\" fill-rule=\"evenodd\" d=\"{}\"/>", path);
  }

  // Ridges, and the hips that lead to them.
  std::string Roofs() const {
    std::string path;
    const auto line = [&](const Eigen::Vector2d& from_uv, const Eigen::Vector2d& to_uv) {
      const Eigen::Vector2d from = Pixel(from_uv), to = Pixel(to_uv);
      path += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", from.x(), from.y(), to.x(), to.y());
    };
    for (const skyquilt::buildings::Part& part : building_.shape.parts) {
      if (part.roof != buildings::RoofKind::kGable && part.roof != buildings::RoofKind::kHip) continue;
      const Eigen::Vector2d low = building_.shape.MinOf(part, true), high = building_.shape.MaxOf(part, true);
      const Eigen::Vector2d along = part.along_u ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
      const Eigen::Vector2d middle = 0.5 * (low + high), half = 0.5 * (high - low);
      const bool hip = part.roof == buildings::RoofKind::kHip;
      // The slopes of a hip roof are equally steep, so the ridge ends as far from the short sides as from the long ones.
      const double reach = along.dot(half) - (hip ? std::min(half.x(), half.y()) : 0.0);
      const Eigen::Vector2d from = middle - reach * along, to = middle + reach * along;
      line(from, to);
      if (!hip) continue;
      line(from, low);
      line(to, high);
      line(from, part.along_u ? Eigen::Vector2d(low.x(), high.y()) : Eigen::Vector2d(high.x(), low.y()));
      line(to, part.along_u ? Eigen::Vector2d(high.x(), low.y()) : Eigen::Vector2d(low.x(), high.y()));
    }
    return path.empty() ? "" : fmt::format("<path class=\"ridge\" d=\"{}\"/>", path);
  }

  // Of the walls that are long enough; of a rectangle two say it all.
  std::string Lengths() const {
    const std::vector<Eigen::Vector2d>& ring = building_.footprint.outer;
    std::string svg;
    const size_t n_labelled = ring.size() == 4 ? 2 : ring.size();
    for (size_t i = 0; i < n_labelled; ++i) {
      const Eigen::Vector2d from = building_.shape.FromEnu(ring[i]), to = building_.shape.FromEnu(ring[(i + 1) % ring.size()]);
      const Eigen::Vector2d from_px = Pixel(from), to_px = Pixel(to);
      const Eigen::Vector2d way = to_px - from_px;
      if (way.norm() < kShortestLabelled_px) continue;
      // The ring is counter-clockwise with y upwards, so that outside is on the left with y downwards.
      const Eigen::Vector2d outward = Eigen::Vector2d(-way.y(), way.x()).normalized();
      const Eigen::Vector2d at = 0.5 * (from_px + to_px) + 12.0 * outward;
      double degrees = std::atan2(way.y(), way.x()) * 180.0 / std::numbers::pi;
      if (degrees > 90.0 || degrees <= -90.0) degrees += degrees > 0.0 ? -180.0 : 180.0;  // never upside down
      svg += fmt::format("<text x=\"{0:.1f}\" y=\"{1:.1f}\" transform=\"rotate({2:.1f} {0:.1f} {1:.1f})\">{3}</text>", at.x(), at.y(), degrees,
                         FormatFixed((to - from).norm() * scale_to_metres_, 2, unit_));
    }
    return svg;
  }

  std::string North() const {
    const Eigen::Vector2d north = Turned({building_.shape.AxisU().y(), building_.shape.AxisV().y()});
    const double degrees = std::atan2(north.x(), north.y()) * 180.0 / std::numbers::pi;  // clockwise from upwards
    return fmt::format("<path class=\"needle\" transform=\"translate({:.1f} 18) rotate({:.1f})\" d=\"M0 -11L5 7L0 3L-5 7Z\"/>", kPlanWidth_px - 18.0,
                       degrees);
  }

  const buildings::Building& building_;
  double scale_to_metres_;
  const char* unit_;
  bool turned_ = false;
  double px_ = 0.0, height_px_ = 0.0;
  Eigen::Vector2d middle_uv_ = Eigen::Vector2d::Zero();
};

}  // namespace

std::string BuildingPlan(const buildings::Building& building, const buildings::BuildingSet& set) {
  return PlanDrawing(building, set).Svg();
}

}  // namespace skyquilt::evaluate::page
