// The second picture of a project: a preview of the orthophoto from the finished context. It has less detail than the one from the sparse points, but
// is what training starts from.
#pragma once

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::coordinator {

// Renders it from the context's checkpoint, in about `seconds`; nothing when there is one already, or an orthophoto. What goes wrong is a warning.
// Throws base::Interrupted only.
void ProvideContextPreview(const survey::Survey& survey, const partition::BlockSet& blocks, const Settings& settings, const Project& project,
                           double seconds, base::ThreadPool& threads);

}  // namespace skyquilt::coordinator
