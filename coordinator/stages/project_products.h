// What `run` and a plain `render` make of a finished scene: orthophoto, surface model, previews and video in products/.
#pragma once

#include "coordinator/project/project.h"
#include "coordinator/rendering/scene_session.h"
#include "products/product_options.h"

namespace skyquilt::coordinator {

// Throws base::InputError, base::UsageError, base::Interrupted.
void MakeProjectProducts(const Project& project, const products::ProductOptions& options, SceneSession& session);

}  // namespace skyquilt::coordinator
