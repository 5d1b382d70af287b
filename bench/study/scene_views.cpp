#include "bench/study/scene_views.h"

#include <fmt/core.h>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/image/normal_image.h"
#include "core/scene/depth_normals.h"
#include "evaluate/photos/choose_photos.h"
#include "evaluate/photos/held_out_scorer.h"

namespace skyquilt::bench {

void WriteViews(const evaluate::EvaluateInput& input, int photos, const std::filesystem::path& folder, base::ThreadPool& threads) {
  base::RequireWritableFolder(folder);
  evaluate::EvaluateInput shown = input;
  // These scores are in the report already and would take time.
  shown.options.lpips_network.clear();
  shown.options.normal_photos.clear();
  evaluate::photos::HeldOutScorer scorer(shown);
  const std::vector<int> chosen = evaluate::photos::SelectEvenly(evaluate::photos::HeldOutPhotos(*input.survey), photos);
  base::Progress progress("views", static_cast<double>(chosen.size()), "photos");
  for (size_t i = 0; i < chosen.size(); ++i) {
    base::ThrowIfCancelled();
    const evaluate::photos::ScoredPhoto scored = scorer.Score(chosen[i], false, threads);
    const evaluate::photos::PhotoResult& findings = scored.findings;
    const auto save = [&](const image::Image8& picture, const char* kind) {
      image::SavePng(picture, folder / ViewPicture(static_cast<int>(i), kind));
    };
    save(scored.task.photo, "photo");
    save(findings.render, "render");
    // Scoring makes normals only where there are true ones.
    save(image::ShowNormals(findings.normals.Empty()
                                ? scene::NormalsOfDepth(scored.task.camera, scored.task.cam_from_enu, findings.z_depth, {}, threads)
                                : findings.normals),
         "normals");
    if (!findings.true_normals.Empty()) save(image::ShowNormals(findings.true_normals), "true_normals");
    if (!findings.true_class.Empty()) save(findings.true_class, "classes");
    progress.Advance(1.0, findings.score.name);
  }
  progress.Finish(fmt::format("{} photos", chosen.size()));
}

std::string ViewPicture(int view, const std::string& kind) {
  return fmt::format("view_{}_{}.png", view, kind);
}

}  // namespace skyquilt::bench
