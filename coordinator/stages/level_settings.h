// Settings for photos that look level, as along facades, round towers and in rooms. How photos look is known when they have poses: after stage
// "prepare", and before the stages that these settings are for.
#pragma once

#include "coordinator/stages/pipeline.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator {

// Where the photos look level, takes pipeline.level_settings as the settings and says so. Nothing is said where that changes no option. Results that
// were made with the other settings, and would not fit these, keep the other ones: programs before this choice made such. Returns whether the
// settings changed. Throws base::UsageError for level settings that are not allowed.
bool UseLevelSettings(Pipeline& pipeline, const survey::Survey& survey);
// The same for a project that has its survey, before its results are compared with the settings; nothing where "prepare" is not finished or is to be
// restarted. Throws base::InputError for a damaged survey.
void RecallLevelSettings(Pipeline& pipeline);

}  // namespace skyquilt::coordinator
