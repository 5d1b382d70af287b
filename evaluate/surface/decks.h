// Measures whether the mesh has the decks of flat roofs at their true height. Simulated surveys only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/raytrace/traced_scene.h"
#include "evaluate/measured.h"
#include "evaluate/photos/flat_roofs.h"
#include "evaluate/surface/joined_mesh.h"
#include "evaluate/surface/samples.h"
#include "evaluate/surface/true_surface.h"

namespace skyquilt::evaluate::surface {

inline constexpr double kDeckEdge_m = 1.0;    // left out around everything that stands on a deck; RoofArea leaves out the same along the walls
inline constexpr double kMeshFacesUp = 0.5;   // smallest upward component of the normals of the mesh on a deck
inline constexpr double kDeckLayers_m = 1.0;  // farther above or below, only the highest surface of the mesh is compared with the deck

struct DeckScore {
  int64_t samples = 0;
  double share_within = kNotMeasured;  // of the samples, those near the height of the deck
};

// roofs: of ReadFlatRoofs, in the simulator's frame. traced_mesh, traced_truth: the surfaces, relative to their middles. A point of the mesh counts
// when the mesh faces up there and, seen from above, the truth shows nothing but deck within kDeckEdge_m; below the mesh's highest surface it counts
// only within kDeckLayers_m of the deck, because ground under a building is no deck. It is right when its height differs by at most tolerance_m from
// the deck's, the median over the deck's true points. The same result for any number of threads.
DeckScore ScoreDecks(const SurfaceMesh& mesh, std::span<const SurfaceSample> mesh_samples, const TrueSurface& truth,
                     const raytrace::TracedScene& traced_mesh, const raytrace::TracedScene& traced_truth, std::span<const photos::RoofArea> roofs,
                     double tolerance_m, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::surface
