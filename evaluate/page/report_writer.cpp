#include "evaluate/page/report_writer.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "core/base/file.h"
#include "evaluate/page/report_images.h"
#include "evaluate/photos/choose_photos.h"
#include "evaluate/photos/picture_of_colors.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr float kErrorHigh = skyquilt::trust::kTopError;  // display values at the top of the error colours
constexpr int kPhotosWithNormals = 2;                     // enough to see how rough surfaces are
constexpr int kPhotosWithMesh = 3;

std::string TitleOf(const std::filesystem::path& project_folder) {
  const std::filesystem::path folder = std::filesystem::absolute(project_folder).lexically_normal();
  // A path that ends in a slash has an empty file name.
  return (folder.filename().empty() ? folder.parent_path() : folder).filename().string();
}

// Removes images of an earlier evaluation that the page no longer shows.
void RemoveStalePictures(const std::filesystem::path& report_folder, const ReportInput& page, const buildings::BuildingsReport* found) {
  std::set<std::string> kept;
  if (page.background) kept.insert(page.background->image);
  for (const PhotoImages& one : page.images) {
    for (const std::string& file : one.Files()) kept.insert(file);
  }
  for (const control::MarkPicture& one : page.mark_pictures) kept.insert({one.photo, one.render});
  for (const ElevationPicture& one : page.elevations) kept.insert(one.image);
  for (const OrthoPicture& one : page.ortho_pictures) kept.insert({one.map, one.truth});
  for (const MaskPicture& one : page.masks.pictures) kept.insert(one.image);
  if (found != nullptr) {
    for (const buildings::BuildingPicture& one : found->pictures) kept.insert(one.file);
  }
  std::vector<std::filesystem::path> stale;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(report_folder / "images", ignored)) {
    const std::string name = entry.path().filename().string();
    const bool ours = name.starts_with("photo_") || name.starts_with("building_") || name.starts_with("elevation_") || name.starts_with("control_") ||
                      name.starts_with("preview_") || name.starts_with("ortho_") || name.starts_with("mask_");
    if (ours && !kept.contains("images/" + name)) stale.push_back(entry.path());
  }
  for (const std::filesystem::path& file : stale) std::filesystem::remove(file, ignored);
}

}  // namespace

ReportPictures::ReportPictures(const EvaluateInput& input, const std::vector<int>& held_out)
    : input_(input), brightness_(CollectBrightness(input.scene->info(), *input.survey, *input.pixels)) {
  if (input.options.report_photos == 0) return;
  pictured_ = photos::SelectEvenly(held_out, input.options.report_photos);
  with_mesh_ = photos::SelectEvenly(pictured_, kPhotosWithMesh);
  contrasted_ = ChooseViews(input.scene->info(), *input.survey, held_out);
  written_.views.resize(contrasted_.size());
}

BrightnessReport ReportPictures::Brightness() const {
  BrightnessReport brightness = brightness_;
  // Photos that were not scored, for lack of time, have no picture.
  std::copy_if(written_.views.begin(), written_.views.end(), std::back_inserter(brightness.views),
               [](const BrightnessView& view) { return !view.photo.empty(); });
  return brightness;
}

bool ReportPictures::ShowsNormal(int photo) const {
  return std::find(contrasted_.begin(), contrasted_.end(), photo) != contrasted_.end();
}

void ReportPictures::Write(const photos::ScoredPhoto& scored) {
  const photos::PhotoResult& findings = scored.findings;
  const int photo = findings.score.photo;
  written_.images.emplace_back();
  if (std::find(pictured_.begin(), pictured_.end(), photo) != pictured_.end()) {
    PhotoPixels pixels{&scored.task.photo, &findings.render, &findings.z_depth, findings.scored.data};
    if (!findings.true_normals.Empty() && written_.n_with_normals < kPhotosWithNormals) {
      pixels.normals = &findings.normals;
      pixels.true_normals = &findings.true_normals;
      ++written_.n_with_normals;
    }
    if (!scored.trust.expected.error.Empty()) pixels.expected_error = &scored.trust.expected.error;
    if (!scored.mesh.Empty() && std::find(with_mesh_.begin(), with_mesh_.end(), photo) != with_mesh_.end()) pixels.mesh = &scored.mesh;
    written_.images.back() =
        WritePhotoImages(pixels, input_.ReportFolder(), fmt::format("photo_{:05d}", photo), input_.options.report_image_width, kErrorHigh);
  }
  const auto place = std::find(contrasted_.begin(), contrasted_.end(), photo);
  if (place != contrasted_.end()) WriteView(scored, static_cast<size_t>(place - contrasted_.begin()));
}

void ReportPictures::WriteView(const photos::ScoredPhoto& scored, size_t view) {
  const photos::PhotoScore& score = scored.findings.score;
  const image::Image8 normal = photos::PictureOf(scored.normal, scored.task.camera.width, scored.task.camera.height);
  BrightnessView& shown = written_.views[view];
  shown = WriteBrightnessView(scored.task.photo, scored.findings.render, normal, input_.ReportFolder(), fmt::format("brightness_{}", view),
                              input_.options.report_image_width);
  shown.name = score.name;
  shown.stops = ExposureStops(input_.scene->info().response, static_cast<size_t>(score.photo));
}

void WriteReport(const EvaluateInput& input, const metrics::Metrics& metrics, const ReportPictures& pictures, std::vector<control::MarkPicture> marks,
                 buildings::BuildingsReport* found, const std::vector<ortho::OrthoCrop>& ortho_crops) {
  const std::filesystem::path report_folder = input.ReportFolder();
  const scene::TrainReport unknown;
  std::vector<std::string> names;
  if (input.training != nullptr) {
    for (const scene::FieldTraining& field : input.training->fields) names.push_back(field.name);
  }
  ReportInput page;
  page.title = TitleOf(input.project_folder);
  page.metrics = &metrics;
  page.survey = input.survey;
  page.blocks = input.blocks;
  page.training = input.training == nullptr ? &unknown : input.training;
  page.curves = metrics::ReadCurves(input.project_folder / "checkpoints", names);
  const BrightnessReport brightness = pictures.Brightness();
  page.brightness = &brightness;
  page.images = pictures.written().images;
  page.files = ReadInputFiles(input.project_folder / "survey" / "input.csv");
  page.masks = CopyMasks(input.project_folder, report_folder);
  page.mark_pictures = std::move(marks);
  if (found != nullptr) {
    const skyquilt::buildings::BuildingSet& set = found->compared.set;
    found->pictures = buildings::WriteBuildingPictures(set, buildings::BuildingsWithCards(set), *input.survey, *input.pixels, report_folder);
  }
  page.buildings = found;
  page.background = CopyMapBackground(input.project_folder / "products", report_folder);
  page.ortho_pictures = WriteOrthoPictures(ortho_crops, report_folder);
  page.elevations = CopyElevations(input.project_folder / "products", report_folder);
  page.color_ramp = WriteColorRamp(report_folder);
  page.error_high = static_cast<double>(kErrorHigh);
  base::WriteFileAtomically(report_folder / "index.html", BuildReportPage(page));
  if (!brightness.Empty()) base::WriteFileAtomically(report_folder / "brightness.json", BrightnessJson(brightness));
  RemoveStalePictures(report_folder, page, found);
  base::WriteFileAtomically(report_folder / "metrics.json", metrics::MetricsJson(metrics));
}

}  // namespace skyquilt::evaluate::page
