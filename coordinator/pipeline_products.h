// What `run` and a plain `render` make of a finished scene: orthophoto, surface model, previews and video in products/.
#pragma once

#include "coordinator/pipeline_project.h"
#include "coordinator/products/product_options.h"
#include "core/base/thread_pool.h"

namespace skyquilt::coordinator {

// Throws base::InputError, base::UsageError, base::Interrupted.
void MakeProjectProducts(const Project& project, const products::ProductOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::coordinator
