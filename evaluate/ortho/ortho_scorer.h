// Scores products/orthophoto.tif: where its colours come from and, in a simulated survey, how it compares with the true map.
#pragma once

#include <filesystem>
#include <optional>

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "evaluate/ortho/ortho_scores.h"

namespace skyquilt::evaluate::ortho {

// Nothing when no orthophoto was made. Files that are missing or damaged, or a truth that lies elsewhere, leave scores out, with a warning in the
// log. Says the scores in the log. The same for any number of threads. Throws base::Interrupted.
std::optional<OrthoResult> ScoreOrtho(const std::filesystem::path& products_folder, const survey::Survey& survey, const scene::SceneInfo& info,
                                      base::ThreadPool& threads);

// One line for people; without truth the sources only.
std::string OrthoSummary(const OrthoScores& scores);

}  // namespace skyquilt::evaluate::ortho
