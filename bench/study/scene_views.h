// Pictures of what a scene shows at held-out photos: colours, and the normals of its surface. They remain when the scene is removed.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/thread_pool.h"
#include "evaluate/evaluate_input.h"

namespace skyquilt::bench {

// Renders `photos` held-out photos, evenly spread, at the brightness at which they were taken, and writes PNG files into the folder, all of a view in
// the size at which the photo is scored:
//   view_0_photo.png, view_0_render.png
//   view_0_normals.png                            of the rendered depth, colours as of image::ShowNormals
//   view_0_true_normals.png, view_0_classes.png   only with a true surface; classes are numbers, survey::SurfaceClass
// Throws base::InputError.
void WriteViews(const evaluate::EvaluateInput& input, int photos, const std::filesystem::path& folder, base::ThreadPool& threads);

// Name of such a file. kind: photo, render, normals, true_normals or classes.
std::string ViewPicture(int view, const std::string& kind);

}  // namespace skyquilt::bench
