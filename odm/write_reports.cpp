#include "odm/write_reports.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/base/thread_pool.h"
#include "core/survey/exif.h"
#include "odm/after_poses.h"
#include "odm/place_files.h"
#include "odm/report/print_page.h"
#include "odm/report/shots.h"
#include "odm/report/stats.h"
#include "surface/files/las_part.h"

namespace skyquilt::odm {
namespace {

namespace fs = std::filesystem;

// Empty tags for a photo that cannot be read any more.
std::vector<survey::PhotoTags> ReadTags(const survey::Survey& survey, base::ThreadPool& threads) {
  std::vector<survey::PhotoTags> tags(survey.photos.size());
  threads.ParallelFor(static_cast<int64_t>(tags.size()), [&](int64_t i, int /*thread*/) {
    const auto at = static_cast<size_t>(i);
    try {
      tags[at] = survey::ReadPhotoTags(survey.photo_root / survey.photos[at].name);
    } catch (const base::InputError& error) {
      base::LogWarning("{}; its tags are missing in the report", error.what());
    }
  });
  return tags;
}

double OrthophotoArea(const fs::path& maps) {
  const fs::path file = maps / "ortho_sources.json";
  if (!fs::exists(file)) return std::numeric_limits<double>::quiet_NaN();
  const nlohmann::json sources = base::ParseJson(base::ReadFile(file));
  const double cell_m = sources.at("cell_m").get<double>();
  return sources.at("cells").get<double>() * cell_m * cell_m;
}

int64_t CloudPoints(const fs::path& surface) {
  const std::vector<fs::path> files = surface::CloudFiles(surface);
  if (files.empty()) return -1;
  int64_t points = 0;
  for (const fs::path& file : files) {
    points += static_cast<int64_t>(surface::LasPart(file, "Make the cloud again with --rerun-from odm_georeferencing").count());
  }
  return points;
}

void WriteJson(const fs::path& file, const nlohmann::ordered_json& json) {
  fs::create_directories(file.parent_path());
  base::WriteFileAtomically(file, base::JsonText(json, 1) + "\n");
}

// The report's page with its pictures, and the page as PDF.
void ProvidePage(const coordinator::Project& project, const fs::path& to) {
  const fs::path page = project.ReportFolder() / "index.html";
  if (!fs::exists(page)) return;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(project.ReportFolder())) {
    if (entry.is_regular_file()) ProvideFile(entry.path(), to / fs::relative(entry.path(), project.ReportFolder()));
  }
  const fs::path browser = FindBrowser();
  if (browser.empty()) {
    base::LogInfo("no report.pdf: Chromium is not installed; {} has the report", (to / "index.html").string());
    return;
  }
  PrintPage(browser, page, to / "report.pdf", project.folder / "report_pdf.log");
}

}  // namespace

void WriteReports(const coordinator::Pipeline& pipeline, const Dataset& dataset, const Wishes& wishes, double seconds) {
  const coordinator::Project& project = pipeline.project;
  if (!fs::exists(project.SurveyFolder() / "survey.json")) return;
  const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
  base::ThreadPool threads(pipeline.settings.run.threads);
  const std::vector<survey::PhotoTags> tags = ReadTags(survey, threads);
  const surface::MapFrame frame = FrameOf(survey, geo::VerticalNamed(pipeline.settings.products.vertical));
  WriteJson(dataset.folder / "cameras.json", CamerasJson(survey));
  WriteJson(dataset.folder / "images.json", ImagesJson(survey, tags));
  const fs::path report = dataset.folder / "odm_report";
  std::error_code error;
  fs::remove_all(report, error);
  if (error) throw base::InputError(report, "cannot be removed: " + error.message(), "Check the permissions of the dataset's folder");
  if (survey.georeferenced) {
    WriteJson(report / "shots.geojson", ShotsJson(survey, frame, tags));
    if (!survey.control.points.empty()) {
      WriteJson(report / "ground_control_points.geojson", ControlPointsJson(survey, frame));
      ProvideFile(report / "ground_control_points.geojson", dataset.folder / "odm_georeferencing" / "ground_control_points.geojson");
    }
  }
  WriteJson(report / "stats.json", StatsJson({.survey = &survey,
                                              .tags = &tags,
                                              .seconds = seconds,
                                              .gsd_m = PhotoGsd(survey),
                                              .area_m2 = OrthophotoArea(project.ProductsFolder()),
                                              .cloud_points = wishes.cloud ? CloudPoints(project.SurfaceFolder()) : -1}));
  if (wishes.report) ProvidePage(project, report);
  for (const std::string& warning : ClosingWarnings(survey)) base::LogWarning("{}", warning);
}

std::vector<std::string> ClosingWarnings(const survey::Survey& survey) {
  constexpr size_t kNamed = 5;
  std::vector<std::string> warnings;
  if (const size_t left_out = survey.unregistered.size(); left_out > 0) {
    const auto named = std::span(survey.unregistered).first(std::min(kNamed, left_out));
    warnings.push_back(fmt::format("{} of {} photos are not used: {}{}; warnings above say why, images.json has all of them", left_out,
                                   left_out + survey.photos.size(), base::Join(named), left_out > kNamed ? ", ..." : ""));
  }
  if (!survey.georeferenced) {
    warnings.emplace_back(
        "the survey has no place on Earth: maps and mesh are in a local frame, and there is no shots.geojson. Add geo.txt or gcp_list.txt to the "
        "photos, or use photos with GPS tags");
  }
  return warnings;
}

}  // namespace skyquilt::odm
