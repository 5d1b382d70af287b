// Renders the pictures of depth from which a surface is fused: one per training photo, and virtual ones where photos leave gaps.
// The places of held-out photos play no part: the mesh is scored from there, and a mesh is best where it was made from.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "surface/surface_input.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Folder, in that of the rendered views, of those that are to stand in their place (see view_files.h).
constexpr const char* kImprovedFolder = "improved";

// Improves the rendered views of photos before gaps are looked for. files: of the rendered views, to be replaced by those of the improved ones, which
// are in folder / kImprovedFolder under the same names. A later call continues where an earlier one was interrupted.
using ImprovePhotoViews = std::function<void(std::span<const ViewPose> poses, const std::string& key, const std::filesystem::path& folder,
                                             std::vector<std::filesystem::path>* files)>;

// Renders the views that are missing in input.work_folder ("views/", one file each, complete or absent), with a progress bar, and joins them in
// views.bin there. A later call with the same work folder continues after the last finished view. Same bits for any number of threads and ranks.
// Throws base::InputError (disk full), base::Interrupted, and what the caster throws.
DepthViews RenderDepthViews(const SurfaceInput& input, double voxel_m, base::ThreadPool& threads, const ImprovePhotoViews& improve = {});

}  // namespace skyquilt::surface
