// The errors to expect, laid on the ground. Each cell of the map is looked at by four rays straight down, one pixel of the photos apart, so that the
// gradient of the picture is that of pixels of the size that the errors were measured in.
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/thread_pool.h"
#include "viewer/protocol/replies.h"
#include "viewer/queries/field_rays.h"
#include "viewer/queries/mean_map.h"

namespace skyquilt::viewer {
namespace {

constexpr size_t kSide = 2;  // rays of a cell along each axis
constexpr size_t kRays = kSide * kSide;

class TrustMapQuery : public Query {
 public:
  TrustMapQuery(const TrustMapRequest& request, trust::Trust trust, PublishPicture publish)
      : request_(request), trust_(std::move(trust)), publish_(std::move(publish)) {}

  bool Step(const FieldAccess& access) override {
    if (!map_) Plan(access);
    const size_t count = kRays * map_->grid().size();
    done_ = CastSome(
        CasterFor(access, Which::kMain), access.batch, done_, count, [this](size_t i) { return RayOf(i); },
        [this](size_t i, const render::RayColor& color) {
          colors_[i % kRays] = color;
          if (i % kRays == kRays - 1) AddCell(i / kRays);
        });
    if (done_ < count) return false;
    Finish();
    return true;
  }
  double fraction() const override { return map_ ? static_cast<double>(done_) / static_cast<double>(kRays * map_->grid().size()) : 0.0; }
  std::string Reply() const override { return TrustMapText(request_.id, result_); }

 private:
  void Plan(const FieldAccess& access) {
    rays_.emplace(access);
    const Eigen::Vector2d low = access.min_enu.head<2>(), high = access.max_enu.head<2>();
    if (!(high.array() > low.array()).all()) throw BadMessage("the size of this scene is not known");
    gsd_m_ = GsdOf(access);
    map_.emplace(low, high, static_cast<double>(kSide) * gsd_m_);
  }

  render::Ray RayOf(size_t i) const {
    const size_t of_cell = i % kRays;
    const Eigen::Vector2d aside(static_cast<double>(of_cell % kSide) - 0.5, 0.5 - static_cast<double>(of_cell / kSide));
    return rays_->At(map_->grid().CentreOf(i / kRays) + gsd_m_ * aside, gsd_m_);
  }

  void AddCell(size_t cell) {
    const trust::RowRays rays = [&](int row, std::span<render::Ray> of_row) {
      for (size_t x = 0; x < kSide; ++x) of_row[x] = RayOf(kRays * cell + static_cast<size_t>(row) * kSide + x);
    };
    const trust::TrustPicture picture = trust::TrustOf(trust_, kSide, kSide, colors_, rays, alone_);
    for (const float error : picture.error.data) {
      if (std::isfinite(error)) map_->Add(map_->grid().CentreOf(cell), static_cast<double>(error));
    }
  }

  void Finish() {
    if (map_->Empty()) throw BadMessage("this scene has no surface that is seen from above");
    result_.min_enu = map_->grid().origin;
    result_.max_enu = map_->grid().max();
    result_.scale = static_cast<double>(trust::kTopError);
    result_.url = publish_(map_->Picture(result_.scale));
  }

  const TrustMapRequest request_;
  const trust::Trust trust_;
  const PublishPicture publish_;
  base::ThreadPool alone_{1};  // a cell is too little for several
  std::optional<VerticalRays> rays_;
  std::optional<MeanMap> map_;
  double gsd_m_ = 0.0;
  size_t done_ = 0;                             // rays
  std::array<render::RayColor, kRays> colors_;  // of the cell whose rays are being cast
  TrustMapResult result_;
};

}  // namespace

std::unique_ptr<Query> MakeTrustMap(const TrustMapRequest& request, trust::Trust trust, PublishPicture publish) {
  if (!publish) throw BadMessage("the trained scene of this project is not loaded, so its errors are not known");
  return std::make_unique<TrustMapQuery>(request, std::move(trust), std::move(publish));
}

}  // namespace skyquilt::viewer
