// What the scene shows from the places of training photos, in small pictures: whether a place is hidden from a photo by what stands before it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "evaluate/photos/coverage.h"

namespace skyquilt::evaluate::photos {

// The views with rendered median depths, in pictures at most 64 pixels wide and high.
std::vector<TrainingView> WithDepths(std::vector<TrainingView> views, const scene::Scene& scene, base::ThreadPool& threads);

// Whether everything that the view's picture of depth shows around a place before its camera is nearer than the place, by more than small pictures
// and blurred surfaces leave open (3 %). False without a picture.
bool IsHidden(const TrainingView& view, const Eigen::Vector3d& x_in_enu);

}  // namespace skyquilt::evaluate::photos
