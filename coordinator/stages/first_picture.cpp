#include "coordinator/stages/first_picture.h"

#include "coordinator/project/stamp.h"
#include "coordinator/scheduler/preview_guard.h"
#include "core/base/log.h"
#include "core/survey/view_kind.h"
#include "products/point_preview.h"
#include "products/product_kinds.h"

namespace skyquilt::coordinator {

void MakeFirstPicture(const Pipeline& pipeline, const survey::Survey& survey, std::chrono::steady_clock::time_point poses_known,
                      base::ThreadPool& threads) {
  if (!products::KindsOf(pipeline.settings.products.kinds, survey::LooksLevel(survey)).ortho) return;
  AsPreview(pipeline.settings, pipeline.project, "preview of the orthophoto", [&](const std::filesystem::path& folder) {
    const products::PointPreview preview = products::MakePointPreview(survey, pipeline.settings.products, folder, threads);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - poses_known).count();
    base::LogInfo("first picture: {}, {:.0f} s after the poses ({} photos on the sparse points, {} x {} cells of {:.3g} m)", preview.picture.string(),
                  seconds, preview.photos, preview.grid.width, preview.grid.height, preview.grid.resolution_m);
  });
}

void ProvideFirstPicture(const Pipeline& pipeline) {
  // Products that were removed are to be made again: a preview in their folder would look as if they were there.
  if (LoadStamp(pipeline.project, "products")) return;
  AsPreview(pipeline.settings, pipeline.project, "preview of the orthophoto", [&](const std::filesystem::path& folder) {
    if (products::FindPreview(folder, products::kFromSparsePoints)) return;
    const auto begin = std::chrono::steady_clock::now();
    base::ThreadPool threads(pipeline.settings.run.threads);
    MakeFirstPicture(pipeline, survey::LoadSurvey(pipeline.project.SurveyFolder()), begin, threads);
  });
}

}  // namespace skyquilt::coordinator
