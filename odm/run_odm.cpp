#include "odm/run_odm.h"

#include <algorithm>

#include "coordinator/stages/level_settings.h"
#include "coordinator/stages/stage.h"
#include "coordinator/stages/stage_bodies.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "odm/after_poses.h"
#include "odm/map_options.h"
#include "odm/option_table.h"
#include "odm/place_files.h"
#include "odm/stage_lines.h"
#include "odm/stage_names.h"
#include "odm/up_to_date.h"
#include "odm/write_reports.h"

namespace skyquilt::odm {
namespace {

namespace fs = std::filesystem;

double SecondsOfStages(const coordinator::Project& project) {
  double seconds = 0.0;
  for (const Step& step : Steps()) {
    if (step.stage == "odm") continue;
    if (const std::optional<coordinator::StageStamp> stamp = coordinator::LoadStamp(project, step.stage)) seconds += stamp->seconds;
  }
  return seconds;
}

class OdmRun {
 public:
  OdmRun(coordinator::Pipeline& pipeline, const Request& request, const Dataset& dataset)
      : pipeline_(pipeline), request_(request), dataset_(dataset), wishes_(WishesOf(request)), lines_(request.name()) {}

  void Run() {
    lines_.Say("Running dataset stage");
    pipeline_.photos = dataset_.images;
    Rerun();
    asked_width_ = pipeline_.settings.run.image_width;
    coordinator::RecallLevelSettings(pipeline_);
    lines_.Say("Finished dataset stage");
    if (end_with_ == "dataset") return;
    for (const Step& step : Steps()) {
      if (!RunsUntil(step, end_with_) || !Wanted(step.stage)) continue;
      lines_.Begin(step);
      if (step.stage == "prepare") {
        Prepare();
      } else if (step.stage == "odm") {
        Place();
      } else {
        RunAnew(step.stage);
      }
      lines_.End(step);
    }
  }

 private:
  // --rerun-all, --rerun-from and --rerun remove results; --rerun and --end-with say where to stop.
  void Rerun() {
    end_with_ = request_.Text("--end-with");
    std::string from = request_.Text("--rerun-from");
    if (request_.Has("--rerun")) from = end_with_ = request_.Text("--rerun");
    if (request_.Has("--rerun-all")) {
      RemoveResultFolders(dataset_.folder);
      RemoveResults(pipeline_.project, "prepare");
    } else if (!from.empty() && !StageBehind(from).empty()) {
      RemoveResults(pipeline_.project, StageBehind(from));
    }
  }

  bool Wanted(const std::string& stage) const {
    if (stage == "products") return wishes_.orthophoto || wishes_.dsm;
    if (stage == "surface") return wishes_.Surface();
    if (stage == "buildings") return coordinator::StageNamed(stage).wanted(pipeline_.settings) && coordinator::KindsOf(pipeline_).buildings;
    if (stage == "evaluate") return wishes_.report;
    return true;
  }

  void RunAnew(const std::string& stage) {
    RemoveIfChanged(pipeline_, stage);
    // Blocks of other photos may have another width.
    if (stage == "partition" && !coordinator::LoadStamp(pipeline_.project, stage)) pipeline_.settings.run.image_width = asked_width_;
    coordinator::RunStage(pipeline_, stage);
  }

  void Prepare() {
    RemoveIfChanged(pipeline_, "prepare");
    coordinator::PrepareStage(pipeline_, dataset_.images, {});
    // The flight decides on the size of the maps' cells, and on the automatic boundary.
    const survey::Survey survey = survey::LoadSurvey(pipeline_.project.SurveyFolder());
    cells_ = CellsOf(request_, survey);
    pipeline_.settings.products.resolution_m = std::min(cells_.orthophoto_m, cells_.heights_m);
    if (!pipeline_.settings.products.boundary.empty()) RequireBoundaryMeets(survey, pipeline_.settings.products.boundary);
    if (request_.Has("--auto-boundary") && pipeline_.settings.products.boundary.empty()) {
      const fs::path file = dataset_.project / "auto_boundary.geojson";
      WriteAutoBoundary(survey, request_.Number("--auto-boundary-distance"), file);
      pipeline_.settings.products.boundary = file.string();
    }
  }

  void Place() {
    PlaceProducts(dataset_, pipeline_.project, wishes_, cells_);
    WriteReports(pipeline_, dataset_, wishes_, SecondsOfStages(pipeline_.project));
    if (request_.Has("--copy-to")) CopyResults(dataset_.folder, fs::absolute(request_.Text("--copy-to")));
    if (request_.Has("--optimize-disk-space")) RemoveSpareFiles();
  }

  // What only a later run would read. The scene stays: views and other products are made of it.
  void RemoveSpareFiles() const {
    std::error_code ignored;
    const coordinator::Project& project = pipeline_.project;
    for (const fs::path& path : {project.folder / "cache", project.CheckpointFolder(), project.SurveyFolder() / "colmap"}) {
      fs::remove_all(path, ignored);
    }
  }

  coordinator::Pipeline& pipeline_;
  const Request& request_;
  const Dataset& dataset_;
  Wishes wishes_;
  StageLines lines_;
  std::string end_with_;
  int asked_width_ = 0;
  MapCells cells_;
};

}  // namespace

std::vector<std::string> OpeningLines(const Request& request, const Dataset& dataset) {
  std::vector<std::string> lines = request.Notes();
  if (dataset.has_groups && !request.Has("--split-image-groups")) {
    lines.push_back("image_groups.txt: taken, without effect: " + FindOption("--split-image-groups")->no_effect);
  }
  return lines;
}

void RunOdm(coordinator::Pipeline& pipeline, const Request& request, const Dataset& dataset) {
  OdmRun(pipeline, request, dataset).Run();
  coordinator::ThrowIfBlocksFailed(pipeline.training, pipeline.project);
}

int StatusForCaller(int status) {
  return status == 3 || status == 4 ? 1 : status;
}

}  // namespace skyquilt::odm
