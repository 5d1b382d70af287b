#include "coordinator/scheduler/kept_blocks.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "coordinator/project/stamp.h"
#include "coordinator/scheduler/train_ledger.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"

namespace skyquilt::coordinator {
namespace {

void Append(std::string& bytes, const double* values, Eigen::Index count) {
  bytes.append(reinterpret_cast<const char*>(values), static_cast<size_t>(count) * sizeof(double));
}

// Identities of the checkpoints by the names of their blocks; empty when they are not known.
std::map<std::string, std::string> CheckpointsOf(const Project& earlier) {
  try {
    return base::ParseJson(base::ReadFile(earlier.CheckpointIdentities())).get<std::map<std::string, std::string>>();
  } catch (const nlohmann::json::exception& error) {
    base::LogWarning("{}: is damaged ({}); all blocks are trained again", earlier.CheckpointIdentities().string(), error.what());
    return {};
  }
}

}  // namespace

std::string TrainingIdentity(const survey::Survey& survey, const partition::Block& block) {
  std::string bytes = fmt::format("{} {} {}\n", block.name, block.log2_table_size, block.empty);
  Append(bytes, block.min_enu.data(), 3);
  Append(bytes, block.max_enu.data(), 3);
  const double sizes[] = {block.margin_m, block.gsd_m, block.finest_voxel_m};
  Append(bytes, sizes, 3);
  for (const int index : block.photos) {
    const survey::Photo& photo = survey.photos.at(static_cast<size_t>(index));
    const camera::Camera& camera = survey.cameras.at(static_cast<size_t>(photo.camera));
    bytes += fmt::format("\n{} {} {} {}x{} ", index, photo.is_test, camera::ModelName(camera.model), camera.width, camera.height);
    Append(bytes, camera.params.data(), static_cast<Eigen::Index>(camera.params.size()));
    Append(bytes, photo.cam_from_enu.rotation.coeffs().data(), 4);
    Append(bytes, photo.cam_from_enu.translation.data(), 3);
  }
  return base::HashHex(bytes);
}

std::vector<FieldOutcome> KeptBlocks(const Project& project, const survey::Survey& survey, const partition::BlockSet& blocks, bool say) {
  const Project earlier = project.Earlier();
  for (const std::filesystem::path& file :
       {earlier.BlocksFile(), earlier.TrainLedgerFile(), earlier.CheckpointIdentities(), earlier.SurveyFolder() / "survey.json"}) {
    if (!std::filesystem::exists(file)) return {};
  }
  const survey::Survey survey_before = survey::LoadSurvey(earlier.SurveyFolder());
  const partition::BlockSet blocks_before = partition::LoadBlocks(earlier.BlocksFile());
  const std::map<std::string, std::string> checkpoints = CheckpointsOf(earlier);
  const std::optional<StageStamp> stamp = LoadStamp(earlier, "train");
  if (!stamp) return {};
  const TrainLedger ledger(earlier, stamp->Hash());
  std::map<std::string, const partition::Block*> before;
  for (const partition::Block& block : blocks_before.blocks) before.emplace(block.name, &block);

  std::vector<FieldOutcome> kept;
  std::vector<std::string> names;
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    const auto found = before.find(block.name);
    std::string why;
    std::optional<FieldOutcome> outcome = ledger.OutcomeOf("block_" + block.name);
    if (found == before.end() || found->second->empty) {
      why = "it is new";
    } else if (TrainingIdentity(survey, block) != TrainingIdentity(survey_before, *found->second)) {
      const auto n_added = std::count_if(block.photos.begin(), block.photos.end(),
                                         [&](int photo) { return static_cast<size_t>(photo) >= survey_before.photos.size(); });
      why = n_added > 0 ? fmt::format("{} of its {} photos were added", n_added, block.photos.size()) : "its box or its photos have changed";
    } else if (!outcome || outcome->failure) {
      why = "it was not trained to the end before";
    } else if (!checkpoints.contains(block.name) || FileIdentity(project.BlockCheckpoint(block.name)) != checkpoints.at(block.name)) {
      why = "its checkpoint is not the one that it had";
    }
    if (!why.empty()) {
      if (say) base::LogInfo("block {} is trained: {}", block.name, why);
      continue;
    }
    outcome->job.block = block.id;
    kept.push_back(*std::move(outcome));
    names.push_back(block.name);
  }
  if (say) base::LogInfo("{} blocks keep their training: {}", kept.size(), kept.empty() ? "all see added photos" : base::Join(names, ", "));
  return kept;
}

}  // namespace skyquilt::coordinator
