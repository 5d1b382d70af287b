#include "coordinator/scheduler/reject_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/image/image.h"
#include "core/render/ray_engine.h"
#include "core/survey/compared_photos.h"
#include "masks/mask_pictures.h"
#include "worker/block_session.h"
#include "worker/robust/find_movers.h"

namespace skyquilt::coordinator {
namespace {

namespace fs = std::filesystem;

constexpr double kMemoryShare = 0.2;  // of the limit, for the photos in cells
constexpr int kLookWidth = 1000, kLookQuality = 85;

bool Finished(const fs::path& file, const std::string& config_hash) {
  if (!fs::exists(file)) return false;
  try {
    worker::RejectedPixels::Load(config_hash, file);
    return true;
  } catch (const base::InputError& error) {
    base::LogWarning("{}; photos are compared again", error.what());
    return false;
  }
}

// Of the photos as trained; NaN without a scale.
double FinestGsd(const partition::BlockSet& blocks) {
  double finest_m = std::numeric_limits<double>::infinity();
  for (const partition::Block& block : blocks.blocks) {
    if (!block.empty) finest_m = std::min(finest_m, block.gsd_m);
  }
  return blocks.georeferenced && std::isfinite(finest_m) ? finest_m : std::numeric_limits<double>::quiet_NaN();
}

// The photo with what is rejected in red; at most kLookWidth pixels wide.
image::Image8 Look(const image::PixelCache& pixels, const worker::RejectedPixels& rejected, size_t photo) {
  const int width = pixels.Width(photo), height = pixels.Height(photo);
  image::Image8 rgb(width, height, 3), mask(width, height, 1);
  rgb.data = pixels.Copy(photo).rgb;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) mask.At(x, y)[0] = rejected.At(photo, x, y) ? 0 : 255;
  }
  return masks::LookPicture(rgb, {.given = {}, .network = std::move(mask), .ground = {}}, kLookWidth);
}

survey::ComparedPhotos ForPeople(const survey::Survey& survey, const image::PixelCache& pixels, const worker::RobustOptions& options,
                                 const worker::Movers& found, const fs::path& folder, base::ThreadPool& threads) {
  survey::ComparedPhotos report{.movers = options.movers,
                                .prefer = options.prefer,
                                .compared = found.compared,
                                .moved = found.moved,
                                .replaced = found.replaced,
                                .unclear = found.unclear};
  std::vector<size_t> training;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (!survey.photos[i].is_test) training.push_back(i);
  }
  report.photos.resize(training.size());
  threads.ParallelFor(static_cast<int64_t>(training.size()), [&](int64_t task, int /*thread*/) {
    const size_t photo = training[static_cast<size_t>(task)];
    survey::ComparedPhoto& one = report.photos[static_cast<size_t>(task)];
    one = {.photo = survey.photos[photo].name, .rejected = found.pixels.Share(photo)};
    if (!(one.rejected > 0.0)) return;
    one.look = one.photo + ".jpg";
    fs::create_directories((folder / one.look).parent_path());
    image::SaveJpeg(Look(pixels, found.pixels, photo), folder / one.look, kLookQuality);
  });
  return report;
}

void LogFound(const survey::ComparedPhotos& report, const fs::path& folder) {
  const auto with = std::ranges::count_if(report.photos, [](const survey::ComparedPhoto& photo) { return photo.rejected > 0.0; });
  if (report.unclear) {
    base::LogWarning(
        "photos disagree about {:.1f} % of what they show, as on waves or where the light changes: what moved cannot be told, and all pixels are "
        "trained on. To ignore them all the same: robust.movers = \"on\"",
        100.0 * report.moved);
  }
  if (report.movers != "off") {
    base::LogInfo("{:.0f} % of the photos could be compared with others; {:.2f} % show what moved", 100.0 * report.compared, 100.0 * report.moved);
  }
  if (report.prefer == "latest") base::LogInfo("{:.2f} % of earlier flights show what later flights do not", 100.0 * report.replaced);
  if (with > 0) base::LogInfo("blocks do not learn from these pixels of {} photos, see {}", with, folder.string());
}

}  // namespace

void ProvideRejectedPixels(const survey::Survey& survey, const partition::BlockSet& blocks, const image::PixelCache& pixels, const Settings& settings,
                           const Project& project, const std::string& config_hash, base::ThreadPool& threads) {
  if (!settings.robust.Any() || Finished(project.RejectedPixels(), config_hash)) return;
  const std::vector<int> no_bands;
  const worker::LoadedContext context = worker::LoadContext(project.ContextCheckpoint(), &no_bands);
  const worker::RaySource source(survey, pixels, context.response);
  const render::FieldSet fields{{}, &context.field};
  const worker::DepthCaster caster = [&](std::span<const render::Ray> rays, std::span<render::RayColor> colors) {
    render::RenderRays(fields, rays, colors, {}, threads);
  };
  const int cell_px = worker::CellPixels(survey, pixels, FinestGsd(blocks), kMemoryShare * settings.run.MemoryLimitBytes());
  const worker::PhotoViews views(survey, pixels, source, context.response, cell_px, caster, threads);
  const worker::Movers found = worker::FindMovers(survey, source, views, settings.robust, cell_px, threads);
  const survey::ComparedPhotos report = ForPeople(survey, pixels, settings.robust, found, project.MoversFolder(), threads);
  survey::SaveComparedPhotos(report, project.MoversFolder());
  found.pixels.Save(config_hash, project.RejectedPixels());
  LogFound(report, project.MoversFolder());
}

}  // namespace skyquilt::coordinator
