// The first picture of a project: a preview of the orthophoto from the sparse points. One from the context follows (scheduler/context_preview.h).
#pragma once

#include <chrono>

#include "coordinator/stages/pipeline.h"
#include "core/base/thread_pool.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator {

// Makes it, in place of an earlier one, and logs how long after the poses it was there; nothing when there is an orthophoto.
// What goes wrong is a warning. Throws base::Interrupted only.
void MakeFirstPicture(const Pipeline& pipeline, const survey::Survey& survey, std::chrono::steady_clock::time_point poses_known,
                      base::ThreadPool& threads);
// Makes it for a prepared survey that has neither this preview nor products, for instance of an older program. Throws base::Interrupted only, and
// base::InputError for a damaged record of the stages.
void ProvideFirstPicture(const Pipeline& pipeline);

}  // namespace skyquilt::coordinator
