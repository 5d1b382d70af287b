// Adds photos to a prepared survey. What it has stays as it is to the last bit: frame, poses, lenses, points, held-out photos. Added photos come
// behind the others with cameras of their own, and bring their points.
#pragma once

#include <filesystem>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "prepare/prepare.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

struct EarlierSurvey {
  std::filesystem::path folder;  // of the survey; another one than the result's
  std::filesystem::path photos;  // folder that its photos came from
};

// `input`: all photos, those of the earlier survey too, which may have other names there; without model and videos. Photos that the earlier survey
// has no pose of are tried again. The tags of added photos are compared with the survey, and place those that have no features in common with it.
// Throws base::InputError when a photo of the earlier survey is missing, when there is nothing to add or nothing of it can be placed, and where
// Prepare does; base::UsageError for panoramas, rigs, and held-out photos whose poses are resected, which are not added.
survey::Survey AddPhotos(const PrepareInput& input, const EarlierSurvey& earlier, const PrepareOptions& options, base::ThreadPool& threads,
                         poses::RemoteTasks* ranks = nullptr);

}  // namespace skyquilt::prepare
