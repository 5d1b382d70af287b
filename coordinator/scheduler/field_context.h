// Connects a project (survey, blocks, settings) with the trainer in worker/: which photos, which box, which options and which files each field gets.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "coordinator/scheduler/field_job.h"
#include "core/base/thread_pool.h"
#include "core/brightness/response.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "partition/block.h"
#include "worker/block_spec.h"

namespace skyquilt::coordinator {

// Brightness of the photos that a project had before others were added to it; it stays what it is. Nothing without such photos.
std::optional<brightness::Response> EarlierResponse(const Project& project);

// Photos and masks in the order of Survey::photos.
std::vector<image::PixelSource> PixelSources(const survey::Survey& survey);

// One block in the form that the trainer takes.
worker::BlockSpec SpecOfBlock(const partition::Block& block);
// The whole survey as one box, for the context: the union of the blocks that are not empty. Throws base::InputError when all are empty.
worker::BlockSpec SpecOfSurvey(const partition::BlockSet& blocks, const survey::Survey& survey, const std::filesystem::path& blocks_file,
                               const Settings& settings);
// How many times the context's tables are doubled: once for each doubling of the blocks beyond 64, at most three times, and only as far as training
// it stays within the memory limit. log2_table_size: of the tables before.
int ContextDoublings(size_t blocks, int log2_table_size, const Settings& settings);

// A function that trains one field. All references must outlive it. It writes checkpoint and training log into the project.
FieldTrainer MakeFieldTrainer(const survey::Survey& survey, const partition::BlockSet& blocks, const image::PixelCache& pixels,
                              const Settings& settings, const Project& project, const std::string& config_hash, base::ThreadPool& threads);

// Steps of the context: context.steps, or half of train.steps (at least 200); 0 when both are 0.
int ContextSteps(const Settings& settings);
// Whether pixels must be read from the cache file on demand, because cache and largest block together exceed the memory of one rank.
bool MustStream(const image::PixelCache& pixels, const survey::Survey& survey, const partition::BlockSet& blocks, const Settings& settings,
                int threads, int ranks_on_machine);
// Memory that every rank needs for photos, points and tracks of the whole survey, in bytes.
double SurveyBytes(const survey::Survey& survey);
// Estimated peak memory of training one block, in bytes: tables with gradient and Adam's two moments, and the workspace of a batch.
double ExpectedTrainingBytes(const partition::Block& block, const worker::TrainOptions& options, int threads);

}  // namespace skyquilt::coordinator
