// The files and folders of one project. Every other part asks here for a path, so the layout on disk is written down once.
#pragma once

#include <filesystem>
#include <string>

#include "core/trust/trust.h"

namespace skyquilt::coordinator {

struct Project {
  std::filesystem::path folder;  // absolute

  std::filesystem::path SimulatedFolder() const { return folder / "simulated"; }
  std::filesystem::path SurveyFolder() const { return folder / "survey"; }
  std::filesystem::path BlocksFile() const { return folder / "blocks.geojson"; }
  std::filesystem::path CheckpointFolder() const { return folder / "checkpoints"; }
  std::filesystem::path ContextCheckpoint() const { return CheckpointFolder() / "context.h5"; }
  std::filesystem::path BlockCheckpoint(const std::string& block_name) const { return CheckpointFolder() / ("block_" + block_name + ".h5"); }
  std::filesystem::path TrainLog(const std::string& field_name) const { return CheckpointFolder() / (field_name + ".log.csv"); }
  std::filesystem::path DiagnosticsLog(const std::string& field_name) const { return CheckpointFolder() / (field_name + ".diagnostics.csv"); }
  std::filesystem::path RejectedPixels() const { return CheckpointFolder() / "rejected_pixels.bin"; }
  std::filesystem::path MoversFolder() const { return folder / "movers"; }
  std::filesystem::path TrainReport() const { return folder / "train.json"; }
  std::filesystem::path PixelCacheFile() const { return folder / "cache" / "pixels.bin"; }
  std::filesystem::path SceneFile() const { return folder / "scene.h5"; }
  std::filesystem::path TrustFile() const { return trust::TrustFileOf(SceneFile()); }
  std::filesystem::path RendersFolder() const { return folder / "renders"; }
  std::filesystem::path ProductsFolder() const { return folder / "products"; }
  std::filesystem::path SurfaceFolder() const { return folder / "surface"; }
  std::filesystem::path SurfaceTable() const { return SurfaceFolder() / "surface.json"; }
  std::filesystem::path SurfaceWorkFolder() const { return folder / "cache" / "surface"; }
  std::filesystem::path BuildingsFolder() const { return folder / "buildings"; }
  std::filesystem::path BuildingsFile() const { return BuildingsFolder() / "buildings.json"; }
  std::filesystem::path TourFile() const { return folder / "tour.json"; }
  std::filesystem::path TourFolder() const { return folder / "tour"; }
  std::filesystem::path TourWorkFolder() const { return TourFolder() / "work"; }
  std::filesystem::path ReportFolder() const { return folder / "report"; }
  std::filesystem::path MetricsFile() const { return ReportFolder() / "metrics.json"; }
  std::filesystem::path EvaluateProgressFile() const { return folder / "cache" / "evaluate_progress.bin"; }
  std::filesystem::path ConfigFile() const { return folder / "config.toml"; }
  std::filesystem::path PlanFile() const { return folder / "plan.json"; }
  std::filesystem::path LogFile() const { return folder / "log.txt"; }
  std::filesystem::path ZonesFolder() const { return folder / "zones"; }
  std::filesystem::path StateFolder() const { return folder / ".state"; }
  std::filesystem::path TrainLedgerFile() const { return StateFolder() / "training.json"; }
  std::filesystem::path TourProposal() const { return StateFolder() / "tour_proposal.txt"; }
  // What the project was before photos were added to it (stages/addition.h), as a small project with the files that this needs.
  Project Earlier() const { return Project{StateFolder() / "before"}; }
  std::filesystem::path CheckpointIdentities() const { return StateFolder() / "checkpoints.json"; }
  std::filesystem::path StampFile(const std::string& stage) const { return StateFolder() / (stage + ".json"); }

  // Creates the folder and proves it writable. Throws base::InputError.
  static Project Create(const std::filesystem::path& folder);
  // Throws base::InputError when the folder does not exist, is not a project (see IsProject) or cannot be written.
  static Project Open(const std::filesystem::path& folder);
  // The same without the writing test: for a folder that may be read-only, or on a full disk.
  static Project OpenToRead(const std::filesystem::path& folder);
  // Whether the folder holds a survey, or the stamp of a "prepare" that was started.
  static bool IsProject(const std::filesystem::path& folder);
};

}  // namespace skyquilt::coordinator
