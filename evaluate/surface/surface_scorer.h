// Scores the surface of a scene: photo by photo beside the field, then in space.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "evaluate/evaluate_input.h"
#include "evaluate/photos/held_out_scorer.h"
#include "evaluate/surface/joined_mesh.h"
#include "evaluate/surface/mesh_picture.h"
#include "evaluate/surface/photo_errors.h"
#include "evaluate/surface/surface_scores.h"

namespace skyquilt::evaluate::surface {

class SurfaceScorer {
 public:
  // mesh: of the finest level, as baked: colours of the field at reference exposure.
  explicit SurfaceScorer(SurfaceMesh mesh);
  SurfaceScorer(const SurfaceScorer&) = delete;
  SurfaceScorer& operator=(const SurfaceScorer&) = delete;

  // Renders the mesh as the photo recorded it, and adds its scores. Returns the picture. Throws base::InputError, base::Interrupted.
  image::Image8 Score(const photos::ScoredPhoto& photo, base::ThreadPool& threads);
  // Scores of all photos so far, of the space where the true surface is known, and what surface.json says. scorer: of the same input. Throws
  // base::InputError for a truth that cannot be read, base::Interrupted.
  SurfaceScores Result(const EvaluateInput& input, const photos::HeldOutScorer& scorer, base::ThreadPool& threads) const;

  // The scores of pictures so far, to save them and to go on from saved ones.
  SurfacePhotoErrors& photos() { return photos_; }

 private:
  const SurfaceMesh mesh_;
  SurfacePainter painter_;
  SurfacePhotoErrors photos_;
};

}  // namespace skyquilt::evaluate::surface
