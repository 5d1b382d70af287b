// The buildings of a project, and their scores.
#pragma once

#include <filesystem>
#include <optional>

#include "buildings/building.h"
#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "evaluate/buildings/building_scores.h"
#include "evaluate/buildings/match_buildings.h"
#include "evaluate/buildings/true_buildings.h"

namespace skyquilt::evaluate::buildings {

// Found buildings beside the true ones.
struct ComparedBuildings {
  BuildingSet set;
  std::optional<TrueBuildings> truth;  // nothing when it is not known
  BuildingMatches matches;             // empty without truth
};

// Reads <project>/buildings/buildings.json; nothing when there is none. The truth is read when the survey has one and is geo-referenced: a local
// frame has no metres and no north to compare with. Throws base::InputError for damaged files, and says how to make them again.
std::optional<ComparedBuildings> LoadBuildingsOf(const std::filesystem::path& project_folder, const survey::Survey& survey);
// The same for any number of threads.
BuildingScores ScoreBuildings(const ComparedBuildings& compared, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::buildings
