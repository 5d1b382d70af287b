#include "coordinator/scheduler/context_preview.h"

#include <algorithm>

#include "coordinator/scheduler/field_context.h"
#include "coordinator/scheduler/preview_guard.h"
#include "core/base/log.h"
#include "core/brightness/luminance.h"
#include "core/checkpoint/archive.h"
#include "core/image/srgb.h"
#include "core/render/ray_engine.h"
#include "core/scene/field_file.h"
#include "core/survey/view_kind.h"
#include "products/field_preview.h"
#include "products/product_kinds.h"

namespace skyquilt::coordinator {
namespace {

// A context that was trained for hours need not be looked at for as long.
constexpr double kMostPreviewSeconds = 30.0;
constexpr double kFewestPreviewSeconds = 1.0;

scene::SceneInfo InfoOfContext(const render::TrainedField& context, const survey::Survey& survey, const partition::BlockSet& blocks,
                               const Settings& settings, const Project& project) {
  scene::SceneInfo info;
  info.origin = blocks.origin;
  info.georeferenced = blocks.georeferenced;
  info.accuracy = blocks.accuracy;
  info.height_reference = blocks.height_reference;
  info.min_enu = context.box.min_enu;
  info.max_enu = context.box.max_enu;
  info.gsd_m = SpecOfSurvey(blocks, survey, project.BlocksFile(), settings).finest_voxel_m;
  return info;
}

void Make(const survey::Survey& survey, const partition::BlockSet& blocks, const Settings& settings, const Project& project, double seconds,
          base::ThreadPool& threads) {
  const std::filesystem::path file = project.ContextCheckpoint();
  const checkpoint::ArchiveReader reader(file);
  const render::TrainedField context = scene::GetField(reader, file, "");
  brightness::Luminance luminance;
  brightness::LuminanceState state;
  brightness::GetLuminance(reader, &luminance, &state);
  // People are shown the concealed rendering of over-exposed surveys.
  const bool conceals = luminance.mode == brightness::LuminanceMode::kOver;
  const render::EngineOptions options = conceals ? render::EngineOptions::For(luminance) : render::EngineOptions{};
  const render::FieldSet fields{{}, &context};
  const products::RayCaster caster = [&](std::span<const render::Ray> rays, std::span<render::RayColor> colors) {
    render::RenderRays(fields, rays, colors, options, threads);
    for (render::RayColor& color : colors) {
      for (size_t c = 0; conceals && color.opacity > 0.0F && c < 3; ++c) {
        color.rgb_srgb[c] = color.opacity * image::SrgbFromLinear(color.concealed_light[c] / color.opacity);
      }
    }
  };
  const products::FieldPreview preview =
      products::MakeFieldPreview(InfoOfContext(context, survey, blocks, settings, project), caster,
                                 std::clamp(seconds, kFewestPreviewSeconds, kMostPreviewSeconds), settings.products, project.ProductsFolder());
  base::LogInfo("picture from the context: {}, {} x {} cells of {:.3g} m", preview.picture.string(), preview.grid.width, preview.grid.height,
                preview.grid.resolution_m);
}

}  // namespace

void ProvideContextPreview(const survey::Survey& survey, const partition::BlockSet& blocks, const Settings& settings, const Project& project,
                           double seconds, base::ThreadPool& threads) {
  if (!products::KindsOf(settings.products.kinds, survey::LooksLevel(survey)).ortho) return;
  AsPreview(settings, project, "preview of the orthophoto from the context", [&](const std::filesystem::path& folder) {
    if (!products::FindPreview(folder, products::kFromContext)) Make(survey, blocks, settings, project, seconds, threads);
  });
}

}  // namespace skyquilt::coordinator
