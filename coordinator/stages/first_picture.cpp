#include "coordinator/stages/first_picture.h"

#include "core/base/errors.h"
#include "core/base/log.h"
#include "products/point_preview.h"

namespace skyquilt::coordinator {

void MakeFirstPicture(const Pipeline& pipeline, const survey::Survey& survey, std::chrono::steady_clock::time_point poses_known,
                      base::ThreadPool& threads) {
  const std::filesystem::path folder = pipeline.project.ProductsFolder();
  if (!pipeline.settings.products.preview || products::HasOrthophoto(folder)) return;
  try {
    const products::PointPreview made = products::MakePointPreview(survey, pipeline.settings.products, folder, threads);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - poses_known).count();
    spdlog::info("first picture: {}, {:.0f} s after the poses ({} photos on the sparse points, {} x {} cells of {:.3g} m)", made.picture.string(),
                 seconds, made.photos, made.grid.width, made.grid.height, made.grid.resolution_m);
  } catch (const base::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    spdlog::warn("there is no preview of the orthophoto: {}", error.what());
  }
}

void ProvideFirstPicture(const Pipeline& pipeline) {
  const std::filesystem::path folder = pipeline.project.ProductsFolder();
  if (!pipeline.settings.products.preview || products::HasOrthophoto(folder)) return;
  try {
    if (products::FindPreview(folder, products::kFromSparsePoints)) return;
    const auto begin = std::chrono::steady_clock::now();
    base::ThreadPool threads(pipeline.settings.run.threads);
    MakeFirstPicture(pipeline, survey::LoadSurvey(pipeline.project.SurveyFolder()), begin, threads);
  } catch (const base::InputError& error) {
    spdlog::warn("there is no preview of the orthophoto: {}", error.what());
  }
}

}  // namespace skyquilt::coordinator
