#include "core/scene/scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/base/errors.h"
#include "core/checkpoint/archive.h"
#include "core/field/hash_field.h"
#include "core/image/srgb.h"
#include "core/render/ray_engine.h"
#include "core/render/ray_segments.h"
#include "core/scene/background.h"
#include "core/scene/camera_rays.h"
#include "core/scene/field_file.h"
#include "core/scene/field_store.h"
#include "core/scene/paged_renderer.h"
#include "core/scene/point_query.h"
#include "core/scene/ray_service.h"
#include "core/scene/scene_file.h"
#include "core/scene/surround.h"

namespace skyquilt::scene {
namespace {

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
    render::EngineOptions options = OfLook(appearance);
    options.step_scale = kStepScale;
    options.normals = appearance.normals;
    return options;
  }
  render::EngineOptions OfLook(const Appearance& appearance) const {
    if (appearance.depths_to_opacity > 0.0) return render::EngineOptions::DepthsOnly(appearance.depths_to_opacity);
    return Conceals(appearance.look) ? render::EngineOptions::For(info.luminance) : render::EngineOptions{};
  }
  // Factor from the light of the background, which has the photos' brightness, to that of a look.
  float BackgroundGain(Rendition look) const {
    if (look == Rendition::kRecorded || !info.luminance.On()) return 1.0F;
    const double sign = info.luminance.mode == brightness::LuminanceMode::kUnder ? -1.0 : 1.0;
    return static_cast<float>(std::exp(sign * info.luminance_state.mean_log_gain));
  }

  void Answer(std::span<const render::Ray> rays, std::span<render::RayColor> out, const Appearance& appearance, base::ThreadPool& threads) {
    const auto start = std::chrono::steady_clock::now();
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
    if (appearance.depths_to_opacity <= 0.0 && Conceals(appearance.look)) ShowConcealed(out);
    scale_check.Check(rays, out);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  SceneInfo info;
  Background background;
  std::unique_ptr<FieldStore> store;
  std::unique_ptr<render::RaySegments> segments;
  std::optional<render::GroundIndex> ground;  // of the blocks; made for the first query
  std::unique_ptr<PagedRenderer> pager;       // for pager_threads
  const base::ThreadPool* pager_threads = nullptr;
  RayService* service = nullptr;
  RenderStatistics statistics;
  double seconds = 0.0;  // of all calls, here or by the service
  ScaleCheck scale_check{Scales()};
};

Scene::Scene() : impl_(std::make_unique<Impl>()) {}
Scene::Scene(Scene&&) noexcept = default;
Scene::~Scene() = default;

const SceneInfo& Scene::info() const {
  return impl_->info;
}
const Background& Scene::background() const {
  return impl_->background;
}

RenderStatistics Scene::statistics() const {
  RenderStatistics statistics = impl_->service != nullptr ? impl_->service->statistics() : impl_->statistics;
  if (impl_->service == nullptr) statistics.field_loads = impl_->store->loads();
  statistics.seconds = impl_->seconds;
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
  info.height_reference = GetHeightReference(reader, scene_h5);
  info.response = brightness::GetResponse(reader, scene_h5);
  brightness::GetLuminance(reader, &info.luminance, &info.luminance_state);
  info.config = reader.StringAttribute("config");
  info.gsd_m = reader.DoubleAttribute("gsd_m");
  info.borders = BordersOf(reader);
  info.scales = GetScales(reader);
  impl.scale_check = ScaleCheck(info.scales);
  impl.background = GetBackground(reader, scene_h5);
  std::vector<SceneBlock> covered;
  for (int64_t i = 0; reader.HasAttribute(kCoveredBlocksAttribute) && i < reader.IntAttribute(kCoveredBlocksAttribute); ++i) {
    const render::TrainedField f = GetDescription(reader, scene_h5, CoveredBlockPrefix(i));
    covered.push_back({f.box, f.name, 0, f.steps, f.seconds, f.samples, true});
  }
  impl.store = std::make_unique<FieldStore>(std::move(reader), scene_h5, options.memory_bytes, info.borders == Borders::kHard);
  const FieldStore& store = *impl.store;
  if (store.size() == 0 && (covered.empty() || !store.HasContext())) {
    throw base::InputError(scene_h5, "has no blocks", "Train at least one block, then merge again");
  }
  info.min_enu = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  info.max_enu = -info.min_enu;
  const auto has_slope = [](const render::TrainedField& f) { return field::HashField(f.config).encoding().HasSlope(); };
  info.density_normals = !store.HasContext() || has_slope(store.context());
  info.normal_head = store.size() > 0;
  for (int k = 0; k < store.size(); ++k) {
    const render::TrainedField& f = store.block(k);
    info.density_normals = info.density_normals && has_slope(f);
    info.normal_head = info.normal_head && f.config.normal_head;
    info.blocks.push_back({f.box, f.name, store.Parameters(k), f.steps, f.seconds, f.samples});
    info.parameters += store.Parameters(k);
  }
  info.blocks.insert(info.blocks.end(), covered.begin(), covered.end());
  for (const SceneBlock& block : info.blocks) {
    info.min_enu = info.min_enu.cwiseMin(block.min_enu);
    info.max_enu = info.max_enu.cwiseMax(block.max_enu);
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

void Scene::RenderRaysOverBackground(std::span<const render::Ray> rays, std::span<render::RayColor> out, const Appearance& appearance,
                                     base::ThreadPool& threads) const {
  SKYQUILT_CHECK(rays.size() == out.size(), std::to_string(rays.size()) + " rays, " + std::to_string(out.size()) + " results");
  const float background_gain = impl_->BackgroundGain(appearance.look);
  impl_->Answer(rays, out, appearance, threads);
  std::optional<Surround> surround;
  if (appearance.plain_surround) surround.emplace(impl_->background);
  for (size_t i = 0; i < out.size(); ++i) {
    if (surround) surround->Fade(rays[i], &out[i]);
    if (out[i].opacity >= 1.0F) continue;
    std::array<float, 3> behind =
        surround ? surround->Behind(rays[i].origin_enu, rays[i].direction_enu) : impl_->background.Color(rays[i].origin_enu, rays[i].direction_enu);
    if (background_gain != 1.0F) {
      for (float& value : behind) value = image::SrgbFromLinear(background_gain * image::LinearFromSrgb(value));
    }
    for (size_t c = 0; c < 3; ++c) out[i].rgb_srgb[c] += (1.0F - out[i].opacity) * behind[c];
  }
  Expose(appearance.log_gain, out);
}

std::vector<render::RayColor> Scene::RenderCamera(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Appearance& appearance,
                                                  base::ThreadPool& threads) const {
  std::vector<render::RayColor> out(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height));
  const CameraRays maker(camera, cam_from_enu, impl_->info.scales.Cones());
  const int n_tiles = TileCount(camera.width, camera.height);
  std::vector<size_t> pixels;
  std::vector<render::Ray> rays;
  std::vector<render::RayColor> colors;
  const int band_tiles = impl_->service != nullptr ? kServiceBandTiles : kBandTiles;
  for (int first = 0; first < n_tiles; first += band_tiles) {
    pixels.clear();
    AppendTilePixels(camera.width, camera.height, first, std::min(first + band_tiles, n_tiles), &pixels);
    rays.resize(pixels.size());
    colors.resize(pixels.size());
    threads.ParallelFor(static_cast<int64_t>((pixels.size() + 255) / 256), [&](int64_t task, int) {
      const size_t begin = static_cast<size_t>(task) * 256;
      const size_t count = std::min<size_t>(256, pixels.size() - begin);
      maker.Make(std::span(pixels).subspan(begin, count), std::span(rays).subspan(begin, count));
    });
    RenderRaysOverBackground(rays, colors, appearance, threads);
    for (size_t i = 0; i < pixels.size(); ++i) out[pixels[i]] = colors[i];
  }
  return out;
}

void Scene::QueryPoints(std::span<const Eigen::Vector3d> x_in_enu, std::span<const Eigen::Vector3d> direction_enu, const PointOptions& options,
                        std::span<PointColor> out, base::ThreadPool& threads) const {
  SKYQUILT_CHECK(impl_->service == nullptr, "a service renders rays only");
  if (!impl_->ground) impl_->ground.emplace(impl_->store->Blocks());
  scene::QueryPoints(*impl_->store, *impl_->ground, x_in_enu, direction_enu, options, out, threads);
}

}  // namespace skyquilt::scene
