// What a rank needs to train any field of one project, loaded once per training.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "coordinator/scheduler/field_job.h"
#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "partition/block.h"
#include "worker/block_spec.h"

namespace skyquilt::coordinator {

// Photos and masks in the order of Survey::photos.
std::vector<image::PixelSource> PixelSources(const survey::Survey& survey);

// One block as the trainer wants it.
worker::BlockSpec SpecOfBlock(const partition::Block& block);
// The whole survey as one box: the union of the blocks that are not empty. Throws base::InputError when all are.
worker::BlockSpec SpecOfSurvey(const partition::BlockSet& blocks, const survey::Survey& survey, const std::filesystem::path& blocks_file);

// A trainer over references that must outlive it; writes the field's log beside its checkpoint.
FieldTrainer MakeFieldTrainer(const survey::Survey& survey, const partition::BlockSet& blocks, const image::PixelCache& pixels,
                              const Settings& settings, const Project& project, const std::string& config_hash, base::ThreadPool& threads);

// Steps of the context: its own, or half of the blocks' (at least 200); 0 when the blocks have none either.
int ContextSteps(const Settings& settings);
// Whether single pixels are to be read from the file, because the cache and the largest block together exceed a rank's share of the memory.
bool MustStream(const image::PixelCache& pixels, const partition::BlockSet& blocks, const Settings& settings, int threads, int ranks_on_machine);
// Rough peak memory of training one block: tables with gradient and two moments, and the workspace of a batch per thread.
double ExpectedTrainingBytes(const partition::Block& block, const worker::TrainOptions& options, int threads);

}  // namespace skyquilt::coordinator
