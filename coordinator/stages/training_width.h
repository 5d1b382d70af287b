// The width of photos for training where run.image_width is "auto": chosen once, when the blocks are made, because their sizes follow from it. From
// then on it is a number, in the settings, in the stamps of the stages and in the project's config.toml.
#pragma once

#include "coordinator/stages/pipeline.h"

namespace skyquilt::coordinator {

// Before stage "partition" runs: chooses the width by the time budget, and says which it is where there is a choice. Nothing where a width is given.
// Throws base::InputError for a damaged survey.
void ChooseTrainingWidth(Pipeline& pipeline);
// Takes the width with which the project's blocks were made. Nothing where there are none, or where a width is given.
void RecallTrainingWidth(const Project& project, Settings* settings);
// The same for both settings of a pipeline, before results are compared with them; nothing where a stage up to "partition" is to be made again, of
// which `stage` is the first.
void RecallTrainingWidth(Pipeline& pipeline, const std::string& stage);

}  // namespace skyquilt::coordinator
