#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "viewer/queries/field_rays.h"
#include "viewer/queries/volume_base.h"
#include "viewer/queries/volume_sums.h"

namespace skyquilt::viewer {
namespace {

constexpr double kCellPixels = 2.0;  // ground sampling distances: finer cells would show the noise of single pixels

// In order: the surface at the corners when the base needs it, the cells of the measured survey, and those of the earlier one when that is the base.
class VolumeQuery : public Query {
 public:
  explicit VolumeQuery(const VolumeRequest& request) : request_(request) {}

  bool Step(const FieldAccess& access) override {
    const RayCaster& caster = CasterFor(access, request_.project);
    const RayCaster* before = request_.base == VolumeBase::kBefore ? &CasterFor(access, Which::kBefore) : nullptr;
    const VerticalRays vertical(access);
    if (!cells_) {
      Plan(access);
      return false;
    }
    const size_t corner_rays = corners_ ? corners_->rays() : 0;
    if (corners_done_ < corner_rays) {
      corners_done_ = CastSome(
          caster, access.batch, corners_done_, corner_rays, [&](size_t i) { return vertical.At(corners_->Place(i), GsdOf(access)); },
          [&](size_t i, const render::RayColor& color) { corners_->Take(i, vertical.Height(color), DepthSpread(color)); });
      if (corners_done_ == corner_rays) FitBase();
      return false;
    }
    const double width_m = std::min(cells_->cell_m(), GsdOf(access));
    const auto ray = [&](size_t i) { return vertical.At(cells_->Centre(i), width_m); };
    if (cells_done_ < cells_->size()) {
      cells_done_ = CastSome(caster, access.batch, cells_done_, cells_->size(), ray, [&](size_t i, const render::RayColor& color) {
        heights_.heights_m[i] = vertical.Height(color);
        heights_.spreads_m[i] = DepthSpread(color);
        heights_.base_m[i] = base_.At(cells_->Centre(i));
      });
      return false;
    }
    if (before != nullptr && before_done_ < cells_->size()) {
      before_done_ = CastSome(*before, access.batch, before_done_, cells_->size(), ray, [&](size_t i, const render::RayColor& color) {
        heights_.base_m[i] = vertical.Height(color);
        // Both surveys err independently.
        heights_.spreads_m[i] = std::hypot(heights_.spreads_m[i], DepthSpread(color));
      });
      return false;
    }
    result_ = SumVolume(request_.polygon_enu, *cells_, heights_, base_.sigma_m);
    return true;
  }
  double fraction() const override {
    if (!cells_) return 0.0;
    const size_t all = (corners_ ? corners_->rays() : 0) + cells_->size() * (request_.base == VolumeBase::kBefore ? 2 : 1);
    return static_cast<double>(corners_done_ + cells_done_ + before_done_) / std::max(1.0, static_cast<double>(all));
  }
  std::string Reply() const override { return VolumeText(request_.id, result_); }

 private:
  void Plan(const FieldAccess& access) {
    const double gsd_m = GsdOf(access);
    cells_.emplace(request_.polygon_enu, kCellPixels * gsd_m);
    if (request_.base == VolumeBase::kPlane || request_.base == VolumeBase::kLowest) corners_.emplace(request_.polygon_enu, gsd_m);
    if (request_.base == VolumeBase::kHeight) base_.height_m = request_.base_height_m;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::vector<double>* values : {&heights_.heights_m, &heights_.base_m, &heights_.spreads_m}) values->assign(cells_->size(), nan);
  }

  void FitBase() { base_ = request_.base == VolumeBase::kPlane ? corners_->FitPlane(CentroidOf(request_.polygon_enu)) : corners_->Lowest(); }

  const VolumeRequest request_;
  std::optional<PolygonCells> cells_;
  std::optional<CornerPatches> corners_;
  BasePlane base_;
  CellHeights heights_;
  size_t corners_done_ = 0, cells_done_ = 0, before_done_ = 0;
  VolumeResult result_;
};

}  // namespace

std::unique_ptr<Query> MakeVolume(const VolumeRequest& request) {
  if (!IsSimplePolygon(request.polygon_enu)) throw BadMessage("the outline crosses or touches itself");
  if (request.base == VolumeBase::kBefore && request.project == Which::kBefore) {
    throw BadMessage("the earlier survey cannot be measured against itself; choose the newer one, or another base");
  }
  return std::make_unique<VolumeQuery>(request);
}

}  // namespace skyquilt::viewer
