#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/errors.h"
#include "core/camera/pixel_pitch.h"
#include "core/checkpoint/archive.h"
#include "core/field/hash_field.h"
#include "core/image/srgb.h"
#include "core/render/ray_engine.h"
#include "core/render/ray_segments.h"
#include "core/scene/background.h"
#include "core/scene/field_store.h"
#include "core/scene/paged_renderer.h"
#include "core/scene/ray_service.h"
#include "core/scene/scene_file.h"

namespace skyquilt::scene {
namespace {

constexpr int kTile = 32;                // pixels
constexpr int kBandTiles = 128;          // tiles rendered at a time: memory does not grow with the image
constexpr int kServiceBandTiles = 1024;  // with a service: more at a time, because its ranks wait for each other at the end of each band

void Expose(const std::array<float, 3>& log_gain, std::span<render::RayColor> colors) {
  for (size_t c = 0; c < 3; ++c) {
    if (log_gain[c] == 0.0F) continue;
    const brightness::Exposure exposure = brightness::Exposure::FromLogGain(log_gain[c]);
    for (render::RayColor& color : colors) color.rgb_srgb[c] = brightness::Expose(color.rgb_srgb[c], exposure).value;
  }
}

// Trained surfaces become thinner than the steps of training, whose phases are random. A rendering has one phase: with steps of that length its
// depths and colours would depend on where the surface lies between two samples.
constexpr double kStepScale = 0.5;

// Replaces the colours by the concealed rendering, as premultiplied display values.
void ShowConcealed(std::span<render::RayColor> colors) {
  for (render::RayColor& color : colors) {
    for (size_t c = 0; c < 3; ++c) {
      color.rgb_srgb[c] = color.opacity > 0.0F ? color.opacity * image::SrgbFromLinear(color.concealed_light[c] / color.opacity) : 0.0F;
    }
  }
}

}  // namespace

struct Scene::Impl {
  // Whether a look is the concealed rendering.
  bool Conceals(Rendition look) const {
    return look == Rendition::kNormal ? info.luminance.mode == brightness::LuminanceMode::kOver
                                      : info.luminance.mode == brightness::LuminanceMode::kUnder;
  }
  render::EngineOptions Options(const Appearance& appearance) const {
    render::EngineOptions options = Conceals(appearance.look) ? render::EngineOptions::For(info.luminance) : render::EngineOptions{};
    options.step_scale = kStepScale;
    options.normals = appearance.normals;
    return options;
  }
  // Factor from the light of the background, which has the photos' brightness, to that of a look.
  float BackgroundGain(Rendition look) const {
    if (look == Rendition::kRecorded || !info.luminance.On()) return 1.0F;
    const double sign = info.luminance.mode == brightness::LuminanceMode::kUnder ? -1.0 : 1.0;
    return static_cast<float>(std::exp(sign * info.luminance_state.mean_log_gain));
  }

  void Answer(std::span<const render::Ray> rays, std::span<render::RayColor> out, const Appearance& appearance, base::ThreadPool& threads) {
    const render::EngineOptions options = Options(appearance);
    if (service != nullptr) {
      service->Render(rays, out, options);
    } else {
      std::vector<RayInFlight> in_flight(rays.size());
      if (pager == nullptr || pager_threads != &threads) {
        pager = std::make_unique<PagedRenderer>(*store, *segments, threads);
        pager_threads = &threads;
      }
      statistics.samples += pager->Continue(rays, in_flight, options, 0, {});
      statistics.rays += static_cast<int64_t>(rays.size());
      for (size_t i = 0; i < rays.size(); ++i) out[i] = render::FinalColor(in_flight[i].state);
    }
    if (Conceals(appearance.look)) ShowConcealed(out);
    scale_check.Look(rays, out);
  }

  SceneInfo info;
  Background background;
  std::unique_ptr<FieldStore> store;
  std::unique_ptr<render::RaySegments> segments;
  std::unique_ptr<PagedRenderer> pager;  // for pager_threads
  const base::ThreadPool* pager_threads = nullptr;
  RayService* service = nullptr;
  RenderStatistics statistics;
  ScaleCheck scale_check{Scales()};
};

Scene::Scene() : impl_(std::make_unique<Impl>()) {}
Scene::Scene(Scene&&) noexcept = default;
Scene::~Scene() = default;

const SceneInfo& Scene::info() const {
  return impl_->info;
}

RenderStatistics Scene::statistics() const {
  if (impl_->service != nullptr) return impl_->service->statistics();
  RenderStatistics statistics = impl_->statistics;
  statistics.field_loads = impl_->store->loads();
  return statistics;
}

Scene Scene::Load(const std::filesystem::path& scene_h5, const SceneOptions& options) {
  checkpoint::ArchiveReader reader = OpenScene(scene_h5);
  Scene scene;
  Impl& impl = *scene.impl_;
  impl.service = options.service;
  SceneInfo& info = impl.info;
  info.origin = {reader.DoubleAttribute("origin_latitude_deg"), reader.DoubleAttribute("origin_longitude_deg"),
                 reader.DoubleAttribute("origin_height_m")};
  info.georeferenced = reader.IntAttribute("georeferenced") != 0;
  info.accuracy = GetAccuracy(reader);
  info.response = brightness::GetResponse(reader, scene_h5);
  brightness::GetLuminance(reader, &info.luminance, &info.luminance_state);
  info.config = reader.StringAttribute("config");
  info.gsd_m = reader.DoubleAttribute("gsd_m");
  info.borders = BordersOf(reader);
  info.scales = GetScales(reader);
  impl.scale_check = ScaleCheck(info.scales);
  impl.background = GetBackground(reader, scene_h5);
  impl.store = std::make_unique<FieldStore>(std::move(reader), scene_h5, options.memory_bytes, info.borders == Borders::kHard);
  const FieldStore& store = *impl.store;
  if (store.size() == 0) throw base::InputError(scene_h5, "has no blocks", "Train at least one block, then merge again");
  info.min_enu = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  info.max_enu = -info.min_enu;
  const auto has_slope = [](const render::TrainedField& f) { return field::HashField(f.config).encoding().HasSlope(); };
  info.density_normals = !store.HasContext() || has_slope(store.context());
  info.normal_head = true;
  for (int k = 0; k < store.size(); ++k) {
    const render::TrainedField& f = store.block(k);
    info.density_normals = info.density_normals && has_slope(f);
    info.normal_head = info.normal_head && f.config.normal_head;
    info.blocks.push_back({f.box, f.name, store.Parameters(k), f.steps, f.seconds, f.samples});
    info.parameters += store.Parameters(k);
    info.min_enu = info.min_enu.cwiseMin(f.box.min_enu);
    info.max_enu = info.max_enu.cwiseMax(f.box.max_enu);
  }
  impl.segments = std::make_unique<render::RaySegments>(store.Blocks());
  if (store.HasContext()) {
    info.parameters += store.ContextParameters();
    info.context_seconds = store.context().seconds;
    info.context_samples = store.context().samples;
  }
  if (impl.service != nullptr) impl.service->Begin(store, *impl.segments);
  // A damaged file must be found now, not in the middle of a rendering.
  if (impl.service == nullptr && store.AllFit()) impl.store->EnsureAllLoaded();
  return scene;
}

void Scene::RenderRays(std::span<const render::Ray> rays, std::span<render::RayColor> out, const Appearance& appearance,
                       base::ThreadPool& threads) const {
  SKYQUILT_CHECK(rays.size() == out.size(), std::to_string(rays.size()) + " rays, " + std::to_string(out.size()) + " results");
  impl_->Answer(rays, out, appearance, threads);
  Expose(appearance.log_gain, out);
}

std::vector<render::RayColor> Scene::RenderCamera(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Appearance& appearance,
                                                  base::ThreadPool& threads) const {
  const Rendition look = appearance.look;
  std::vector<render::RayColor> out(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height));
  const geo::Rigid3d enu_from_cam = cam_from_enu.Inverse();
  // Scenes without cones use the pitch for the length of steps only.
  const auto nominal = static_cast<float>(1.0 / std::max(1e-9, camera.FocalX()));
  const std::optional<camera::PixelPitch> pitch = impl_->info.scales.Cones() ? std::optional<camera::PixelPitch>(camera) : std::nullopt;
  // Square tiles: rays that are rendered together see the same places, so the hash table entries they read are in cache.
  const int tile_columns = (camera.width + kTile - 1) / kTile;
  const int n_tiles = tile_columns * ((camera.height + kTile - 1) / kTile);
  const float background_gain = impl_->BackgroundGain(look);
  std::vector<size_t> pixels;
  std::vector<render::Ray> rays;
  std::vector<render::RayColor> colors;
  const int band_tiles = impl_->service != nullptr ? kServiceBandTiles : kBandTiles;
  for (int first = 0; first < n_tiles; first += band_tiles) {
    pixels.clear();
    for (int tile = first; tile < std::min(first + band_tiles, n_tiles); ++tile) {
      const int x0 = tile % tile_columns * kTile, y0 = tile / tile_columns * kTile;
      for (int y = y0; y < std::min(y0 + kTile, camera.height); ++y) {
        for (int x = x0; x < std::min(x0 + kTile, camera.width); ++x) {
          pixels.push_back(static_cast<size_t>(y) * static_cast<size_t>(camera.width) + static_cast<size_t>(x));
        }
      }
    }
    rays.assign(pixels.size(), render::Ray{});
    colors.resize(pixels.size());
    threads.ParallelFor(static_cast<int64_t>((pixels.size() + 255) / 256), [&](int64_t task, int) {
      const size_t begin = static_cast<size_t>(task) * 256;
      for (size_t i = begin; i < std::min(begin + 256, pixels.size()); ++i) {
        const auto width = static_cast<size_t>(camera.width);
        const size_t row = pixels[i] / width, column = pixels[i] % width;
        const Eigen::Vector2d img(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
        rays[i].origin_enu = enu_from_cam.translation;
        rays[i].direction_enu = (enu_from_cam.rotation * camera.RayFromImg(img)).normalized();
        rays[i].pixel_pitch = pitch ? static_cast<float>(pitch->At(img)) : nominal;
      }
    });
    impl_->Answer(rays, colors, appearance, threads);
    for (size_t i = 0; i < colors.size(); ++i) {
      if (colors[i].opacity >= 1.0F) continue;
      std::array<float, 3> behind = impl_->background.Color(rays[i].origin_enu, rays[i].direction_enu);
      if (background_gain != 1.0F) {
        for (float& value : behind) value = image::SrgbFromLinear(background_gain * image::LinearFromSrgb(value));
      }
      for (size_t c = 0; c < 3; ++c) colors[i].rgb_srgb[c] += (1.0F - colors[i].opacity) * behind[c];
    }
    Expose(appearance.log_gain, colors);
    for (size_t i = 0; i < pixels.size(); ++i) out[pixels[i]] = colors[i];
  }
  return out;
}

}  // namespace skyquilt::scene
