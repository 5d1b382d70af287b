// Improves the rendered depths of all photos of a survey by comparing the photos (refine_view.h), and keeps of the result what photos agree on.
// Held-out photos play no part.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "surface/surface_input.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// The call of ImprovePhotoViews (views/render_depth_views.h); input.photos must be set. A depth that another photo confirms
// has kConfirmedWeight, one that remains as rendered half of kFullWeight. Rendered views are removed one by one as improved ones replace them. As
// many photos as fit in a tenth of input.memory_bytes are kept in memory. Same bits for any number of threads. Throws base::InputError and
// base::Interrupted.
void RefineViews(const SurfaceInput& input, std::span<const ViewPose> poses, const std::string& key, const std::filesystem::path& folder,
                 std::vector<std::filesystem::path>* files, base::ThreadPool& threads);

}  // namespace skyquilt::surface
