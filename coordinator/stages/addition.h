// Photos that are added to a finished project. What it was before is kept in .state/before: "prepare" adds photos to that survey, "partition" blocks
// to those blocks, and "train" trains the blocks for which something has changed. It stays until photos are added again, so that all of that can be
// killed at any moment, and repeated.
#pragma once

#include <filesystem>
#include <string>

#include "coordinator/project/project.h"
#include "coordinator/stages/pipeline.h"
#include "prepare/add_photos.h"

namespace skyquilt::coordinator {

// Keeps what the project is now, unless an addition that is not trained yet has begun: then it stays what it was before that. Throws
// base::UsageError when the project is not trained, or is one of videos or masks, to which nothing is added.
void BeginAddition(const Pipeline& pipeline);
// Whether the project's survey is an earlier one with added photos.
bool IsAddition(const Project& project);
// Whether new inputs of this stage are those of an addition, so that it may run again without the user's consent.
bool FollowsAddition(const Project& project, const std::string& stage);
prepare::EarlierSurvey EarlierSurveyOf(const Project& project);
// Deletes what "train" has made, except for the blocks that keep it.
void RemoveChangedFields(const Project& project);
// The folder of all photos: those of the project, and the given folders. Throws base::UsageError when the project has no survey, or one of videos,
// and what LinkZones throws.
std::filesystem::path FolderWithAdded(const Project& project, const std::vector<std::filesystem::path>& folders);

}  // namespace skyquilt::coordinator
