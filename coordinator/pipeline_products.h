// What `run` and a plain `render` make of a finished scene: orthophoto, surface model, previews and video in products/.
#pragma once

#include "coordinator/pipeline_project.h"
#include "coordinator/products/product_options.h"
#include "coordinator/rendering/scene_session.h"

namespace skyquilt::coordinator {

// Throws base::InputError, base::UsageError, base::Interrupted.
void MakeProjectProducts(const Project& project, const products::ProductOptions& options, SceneSession& session);

}  // namespace skyquilt::coordinator
