// Renders held-out photos at the brightness at which they were taken, and scores them one by one. Writes no files.
#pragma once

#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/metrics/lpips.h"
#include "core/scene/scene.h"
#include "evaluate/evaluate_input.h"
#include "evaluate/photos/coverage.h"
#include "evaluate/photos/floater_opacity.h"
#include "evaluate/photos/photo_response.h"
#include "evaluate/photos/photo_scorer.h"
#include "evaluate/photos/photo_trust.h"

namespace skyquilt::evaluate::photos {

struct ScoredPhoto {
  HeldOutPhoto task;
  PhotoResult findings;                  // with all scores filled in
  FloaterOpacity floaters;               // no rays without true depth
  PhotoResponse recording;               // that was applied to the rendering
  std::vector<render::RayColor> normal;  // rendered at normal brightness, row-major; empty when not requested
  PhotoTrust trust;                      // nothing where it was not measured
  image::Image8 mesh;                    // the surface's mesh at the photo's brightness (surface_scorer.h); empty without a surface
};

class HeldOutScorer {
 public:
  // `input` must outlive it. Throws base::InputError for an LPIPS network that cannot be used.
  explicit HeldOutScorer(const EvaluateInput& input);

  // photo: index into Survey::photos. keep_normal: return the rendering at normal brightness too. Throws base::InputError when a file cannot be read.
  ScoredPhoto Score(int photo, bool keep_normal, base::ThreadPool& threads);

  const std::vector<TrainingView>& training() const { return training_; }
  const TrainingViews& views() const { return views_; }  // the same; nothing hides places from them
  const SceneArea& area() const { return area_; }
  size_t n_boxes() const { return area_.boxes.size(); }  // size of PhotoResult::per_block

 private:
  // Brightness of the photo by its tags, and with the gain that training predicts for it.
  struct Recordings {
    double gain = 1.0;
    PhotoResponse tagged, predicted;
    bool Differ() const { return predicted.log_gain != tagged.log_gain; }
  };
  Recordings RecordingsOf(int photo) const;
  // Whether the rendering at normal brightness has the colours of the recorded one before the photo's response.
  bool LooksAreAlike() const;
  // as_rendered: takes the rendering before the response; may be null.
  PhotoResult ScoreRecorded(int photo, const HeldOutPhoto& task, base::ThreadPool& threads, std::vector<render::RayColor>* as_rendered,
                            PhotoTrust* trust) const;
  // Fits the photo's pose to the scene and scores it on the tiles that were not fitted. as_given: at the photo's brightness.
  void ScoreResected(const HeldOutPhoto& task, const PhotoResponse& recording, std::span<const render::RayColor> as_given, base::ThreadPool& threads,
                     PhotoResult* findings) const;
  std::vector<render::RayColor> RenderNormal(const HeldOutPhoto& task, base::ThreadPool& threads) const;

  const EvaluateInput& input_;
  const SceneArea area_;
  const std::vector<TrainingView> training_;
  const TrainingViews views_;
  std::optional<TrainingViews> unhidden_;  // where photos look level: the same, from which the scene hides places; rendered for the first photo
  std::optional<skyquilt::metrics::Lpips> lpips_;
};

}  // namespace skyquilt::evaluate::photos
