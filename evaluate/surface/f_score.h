// Measures in space how well a mesh agrees with the true surface of a simulated survey: shares within distances, from the mesh to the truth
// (precision) and from the truth to the mesh (recall).
#pragma once

#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/block_box.h"
#include "evaluate/surface/joined_mesh.h"
#include "evaluate/surface/samples.h"
#include "evaluate/surface/seen_surface.h"
#include "evaluate/surface/surface_scores.h"

namespace skyquilt::evaluate::surface {

// Names and lengths of the distances at which shares are measured. Without a ground sampling distance (0) only those in centimetres.
struct ScoredDistance {
  std::string name;
  double tau_m = 0.0;
};
std::vector<ScoredDistance> ScoredDistances(double gsd_m);

struct SurfaceComparison {
  SurfaceAgreement all;                    // every class but moving cars, water and what has none
  std::vector<SurfaceAgreement> by_class;  // one per ScoredClasses() (photo_errors.h)
};

// What is compared. All must outlive the calls.
struct SurfacePair {
  const SurfaceMesh& mesh;
  const TrueSurface& truth;
  const SeenSurface& seen;
  std::span<const geo::BlockBox> boxes;  // the scene's, seen from above
  double gsd_m = 0.0;
};

// Points of the mesh inside the boxes: two per square of a ground sampling distance, at most two million.
std::vector<SurfaceSample> SampleMesh(const SurfacePair& pair);

// The true surface counts where `seen` says so. A point of the mesh counts when its nearest true point does, and also when no true point is near it;
// points outside the boxes do not count. Distances are exact, to triangles; those of more than twice the largest scored distance are taken as
// infinite. The same result for any number of threads. Throws base::Interrupted.
SurfaceComparison CompareSurfaces(const SurfacePair& pair, std::span<const SurfaceSample> mesh_samples, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::surface
