#include "products/photo_mosaic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/progress.h"
#include "core/image/srgb.h"

namespace skyquilt::products {
namespace {

constexpr double kPixelsPerCell = 1.2;  // of a photo, along an axis
constexpr double kBlend = 0.01;         // cost in which the weight of a photo falls to 1/e
constexpr double kNegligible = 5.0;     // in units of kBlend
constexpr double kRim = 0.08;           // of the shorter side of a photo, where it gives way to others
constexpr int kCompared = 4;            // photos of a place whose brightness is compared
constexpr int kPatch = 2;               // half width of the patch that is compared, pixels
constexpr float kDarkest = 0.004F;      // linear light that is compared: neither noise nor clipped
constexpr float kBrightest = 0.85F;

// Linear light of the 256 display values.
const std::array<float, 256>& LightOfBytes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> light{};
    for (size_t i = 0; i < light.size(); ++i) light[i] = image::LinearFromSrgb(static_cast<float>(i) / 255.0F);
    return light;
  }();
  return table;
}

std::optional<Eigen::Vector2d> PixelOf(const MosaicPhoto& photo, const Eigen::Vector3d& place_enu) {
  const std::optional<Eigen::Vector2d> pixel = photo.camera.ImgFromCam(photo.cam_from_enu * place_enu);
  if (!pixel || !(pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= photo.rgb.width && pixel->y() <= photo.rgb.height)) return std::nullopt;
  return pixel;
}

bool IsMasked(const MosaicPhoto& photo, const Eigen::Vector2d& pixel) {
  if (photo.mask.Empty()) return false;
  const int x = std::min(static_cast<int>(pixel.x()), photo.mask.width - 1), y = std::min(static_cast<int>(pixel.y()), photo.mask.height - 1);
  return *photo.mask.At(x, y) == 0;
}

// Linear light between the four nearest pixels.
std::array<float, 3> LightAt(const MosaicPhoto& photo, const Eigen::Vector2d& pixel) {
  const std::array<float, 256>& light = LightOfBytes();
  const image::Image8& rgb = photo.rgb;
  const double x = std::clamp(pixel.x() - 0.5, 0.0, rgb.width - 1.0), y = std::clamp(pixel.y() - 0.5, 0.0, rgb.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, rgb.width - 1), y1 = std::min(y0 + 1, rgb.height - 1);
  const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
  const uint8_t *a = rgb.At(x0, y0), *b = rgb.At(x1, y0), *c = rgb.At(x0, y1), *d = rgb.At(x1, y1);
  std::array<float, 3> result{};
  for (size_t k = 0; k < 3; ++k) {
    result[k] = (1.0F - v) * ((1.0F - u) * light[a[k]] + u * light[b[k]]) + v * ((1.0F - u) * light[c[k]] + u * light[d[k]]);
  }
  return result;
}

// Mean light of a patch; NaN for colours that are too dark or too bright to be compared, and where the patch is masked.
std::array<float, 3> PatchLight(const MosaicPhoto& photo, const Eigen::Vector3d& place_enu) {
  std::array<float, 3> mean;
  mean.fill(std::numeric_limits<float>::quiet_NaN());
  const std::optional<Eigen::Vector2d> pixel = PixelOf(photo, place_enu);
  if (!pixel || IsMasked(photo, *pixel)) return mean;
  const int x = static_cast<int>(pixel->x()), y = static_cast<int>(pixel->y());
  if (x < kPatch || y < kPatch || x + kPatch >= photo.rgb.width || y + kPatch >= photo.rgb.height) return mean;
  std::array<float, 3> sum{};
  for (int dy = -kPatch; dy <= kPatch; ++dy) {
    for (int dx = -kPatch; dx <= kPatch; ++dx) {
      for (size_t k = 0; k < 3; ++k) sum[k] += LightOfBytes()[photo.rgb.At(x + dx, y + dy)[k]];
    }
  }
  constexpr float kPixels = (2 * kPatch + 1) * (2 * kPatch + 1);
  for (size_t k = 0; k < 3; ++k) {
    const float light = sum[k] / kPixels;
    if (light > kDarkest && light < kBrightest) mean[k] = light;
  }
  return mean;
}

MosaicPhoto ReadMosaicPhoto(const survey::Survey& survey, const survey::Photo& photo, double ground_z, double cell_m) {
  const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
  MosaicPhoto read;
  read.cam_from_enu = photo.cam_from_enu;
  read.eye_enu = photo.cam_from_enu.OriginInSource();
  const double gsd_m = camera::GroundSamplingDistance(camera, std::max(read.eye_enu.z() - ground_z, 1e-6));
  const double wanted = std::min<double>(camera.width, std::ceil(kPixelsPerCell * camera.width * gsd_m / cell_m));
  const int width = std::max(1, static_cast<int>(wanted));
  read.rgb = image::LoadReducedRgb8(survey.photo_root / photo.name, width);
  if (read.rgb.width > width) read.rgb = image::Resize(read.rgb, width, image::ScaledHeight(camera.width, camera.height, width));
  if (!photo.mask.empty()) read.mask = image::ResizeMask(image::LoadMask(photo.mask), read.rgb.width, read.rgb.height);
  read.camera = camera.Resized(read.rgb.width, read.rgb.height);
  return read;
}

}  // namespace

std::vector<MosaicPhoto> ReadMosaicPhotos(const survey::Survey& survey, std::span<const char> chosen, double ground_z, double cell_m,
                                          base::ThreadPool& threads, std::vector<std::string>* failures) {
  std::vector<MosaicPhoto> photos(survey.photos.size());
  std::vector<std::string> reasons(photos.size());
  base::Progress progress("preview", static_cast<double>(std::count(chosen.begin(), chosen.end(), 1)), "photos");
  threads.ParallelFor(static_cast<int64_t>(photos.size()), [&](int64_t task, int /*thread*/) {
    const auto i = static_cast<size_t>(task);
    if (chosen[i] == 0) return;
    base::ThrowIfCancelled();
    try {
      photos[i] = ReadMosaicPhoto(survey, survey.photos[i], ground_z, cell_m);
    } catch (const base::InputError& error) {
      reasons[i] = error.what();
    }
    progress.Advance();
  });
  progress.Finish();
  for (const std::string& reason : reasons) {
    if (!reason.empty()) failures->push_back(reason);
  }
  return photos;
}

void EqualiseBrightness(std::span<const Eigen::Vector3d> places_enu, std::span<const BestViews> views, std::vector<MosaicPhoto>* photos) {
  std::vector<OverlapRatio> ratios;
  for (size_t i = 0; i < places_enu.size(); ++i) {
    std::array<std::array<float, 3>, kCompared> light{};
    std::array<int32_t, kCompared> shown{};
    size_t n = 0;
    for (const int32_t photo : views[i]) {
      if (photo < 0 || n == kCompared || (*photos)[static_cast<size_t>(photo)].rgb.Empty()) continue;
      light[n] = PatchLight((*photos)[static_cast<size_t>(photo)], places_enu[i]);
      shown[n++] = photo;
    }
    for (size_t a = 0; a < n; ++a) {
      for (size_t b = a + 1; b < n; ++b) {
        OverlapRatio ratio{shown[a], shown[b], {}};
        for (size_t k = 0; k < 3; ++k) ratio.log_ratio[k] = std::log(light[a][k] / light[b][k]);
        ratios.push_back(ratio);
      }
    }
  }
  const std::vector<std::array<float, 3>> gains = GainsOfOverlaps(photos->size(), ratios);
  for (size_t i = 0; i < photos->size(); ++i) {
    for (size_t k = 0; k < 3; ++k) (*photos)[i].gain[k] = std::exp(gains[i][k]);
  }
}

MosaicPainter::MosaicPainter(const std::vector<MosaicPhoto>& photos, double typical_height_m)
    : photos_(photos), typical_height_m_(typical_height_m) {}

std::array<uint8_t, 4> MosaicPainter::ColorAt(const Eigen::Vector3d& place_enu, std::span<const int32_t> candidates) const {
  struct RankedView {
    double cost;
    int32_t photo;
  };
  struct Contender {
    double cost;
    const MosaicPhoto* photo;
    Eigen::Vector2d pixel;
  };
  constexpr size_t kMost = 4 * kBestViews;
  SKYQUILT_CHECK(candidates.size() <= kMost, std::to_string(candidates.size()) + " candidates");
  std::array<RankedView, kMost> views{};
  size_t n = 0;
  for (const int32_t photo : candidates) {
    const MosaicPhoto& candidate = photos_[static_cast<size_t>(photo)];
    if (candidate.rgb.Empty()) continue;
    const double cost = ViewCost(place_enu, candidate.eye_enu, typical_height_m_);
    if (std::isfinite(cost)) views[n++] = {cost, photo};
  }
  std::sort(views.begin(), views.begin() + static_cast<std::ptrdiff_t>(n),
            [](const RankedView& a, const RankedView& b) { return a.cost < b.cost || (a.cost == b.cost && a.photo < b.photo); });
  std::array<Contender, kMost> contenders{};
  size_t found = 0;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < n && views[i].cost <= least + kNegligible * kBlend; ++i) {
    const MosaicPhoto& photo = photos_[static_cast<size_t>(views[i].photo)];
    const std::optional<Eigen::Vector2d> pixel = PixelOf(photo, place_enu);
    if (!pixel || IsMasked(photo, *pixel)) continue;
    const double width = photo.rgb.width, height = photo.rgb.height;
    const double inside = std::min({pixel->x(), pixel->y(), width - pixel->x(), height - pixel->y()}) / (kRim * std::min(width, height));
    const double cost = views[i].cost + (inside < 1.0 ? kBlend * (1.0 / std::max(inside, 1e-4) - 1.0) : 0.0);
    contenders[found++] = {cost, &photo, *pixel};
    least = std::min(least, cost);
  }
  if (found == 0) return {0, 0, 0, 0};
  std::array<float, 3> sum{};
  float weights = 0.0F;
  for (size_t i = 0; i < found; ++i) {
    const double behind = (contenders[i].cost - least) / kBlend;
    if (behind > kNegligible) continue;
    // 0 where the photo is left out, so that its coming and going does not show.
    const auto weight = static_cast<float>(std::exp(-behind) - std::exp(-kNegligible));
    const std::array<float, 3> light = LightAt(*contenders[i].photo, contenders[i].pixel);
    for (size_t k = 0; k < 3; ++k) sum[k] += weight * contenders[i].photo->gain[k] * light[k];
    weights += weight;
  }
  std::array<uint8_t, 4> color = {0, 0, 0, 255};
  for (size_t k = 0; k < 3; ++k) {
    color[k] = static_cast<uint8_t>(std::lround(255.0F * std::clamp(image::SrgbFromLinear(sum[k] / weights), 0.0F, 1.0F)));
  }
  return color;
}

}  // namespace skyquilt::products
