// Between context and blocks: finds pixels of photos that blocks must not learn from (worker/robust/find_movers.h), once for all ranks.
#pragma once

#include <string>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::coordinator {

// With options of [robust] that are on: writes Project::RejectedPixels, from the finished context, and pictures for people into
// Project::MoversFolder; nothing when the file is there already. config_hash: of the training. Throws base::InputError when they cannot be written,
// base::Interrupted.
void ProvideRejectedPixels(const survey::Survey& survey, const partition::BlockSet& blocks, const image::PixelCache& pixels, const Settings& settings,
                           const Project& project, const std::string& config_hash, base::ThreadPool& threads);

}  // namespace skyquilt::coordinator
