// The model by tags and verified matches (prepare/seeded), in place of COLMAP's mapper.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_commands.h"
#include "prepare/poses/colmap_step.h"
#include "prepare/poses/seed/seed_input.h"

namespace skyquilt::prepare::poses {

constexpr const char* kSeededStep = "seeded";

// A number of the tags for a text of inputs; "-" where there is none.
std::string TagText(const std::optional<double>& value);

// What the model depends on besides the matches and the tags that pairs depend on, and the version of the way it is made.
std::string SeedInputs(const std::vector<input::PhotoFile>& photos);

// The photos with their tags, features and verified matches from COLMAP's database. Nothing when the database has no features for them; `reason` then
// says so. Throws base::InputError for a damaged database.
std::optional<SeedInput> ReadSeedInput(const std::filesystem::path& database, const std::vector<input::PhotoFile>& photos, std::string* reason);

// Replaces the job's seeded model by a new one, with the colours of the photos; by none when the tags or the result cannot be trusted. The log says
// which, and why. Throws base::InputError for a damaged database and for files that cannot be written, base::Interrupted when asked to stop.
void SeedModel(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, base::ThreadPool& threads);

// What SeedModel made. The step must be done.
std::optional<FoundModel> SeededModelOf(const ColmapJob& job);

}  // namespace skyquilt::prepare::poses
