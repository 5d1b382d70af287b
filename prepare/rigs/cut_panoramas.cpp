#include "prepare/rigs/cut_panoramas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/text.h"
#include "prepare/rigs/view_files.h"
#include "prepare/tables/csv_field.h"

namespace skyquilt::prepare::rigs {
namespace {

namespace fs = std::filesystem;

constexpr const char *kViewsName = "views", *kMasksName = "view_masks", *kPlanName = "views.json", *kTableName = "views.csv",
                     *kRigName = "rig_config.json";

bool SaysPanorama(const input::PhotoFile& photo) {
  return photo.tags.panorama.has_value();
}

bool HasShapeOfPanorama(const input::PhotoFile& photo) {
  return photo.width == 2 * photo.height;
}

// Views are JPEGs whatever the panorama is.
std::string ViewName(const PanoramaView& view, const std::string& panorama) {
  const std::string extension = base::LowerCase(fs::path(panorama).extension().string());
  return view.prefix + panorama + (extension == ".jpg" || extension == ".jpeg" ? "" : ".jpg");
}

std::vector<PanoramaJob> JobsOf(const std::vector<size_t>& panoramas, const PanoramaOptions& options, const std::vector<PanoramaView>& views,
                                const input::PhotoSet& photos) {
  std::vector<PanoramaJob> jobs;
  for (const size_t i : panoramas) {
    PanoramaJob& job = jobs.emplace_back();
    job.photo = photos.usable[i];
    job.area = AreaOf(job.photo);
    const int width = options.width > 0 ? options.width : WidthAsSharp(job.area.sphere.width, options.fov_deg);
    const double focal_px = ViewFocal(width, options.fov_deg);
    job.camera = {camera::CameraModel::kPinhole, width, width, {focal_px, focal_px, 0.5 * width, 0.5 * width}};
    for (const PanoramaView& view : views) job.names.push_back(ViewName(view, job.photo.name));
  }
  return jobs;
}

std::string FileText(const fs::path& file) {
  std::error_code error;
  const auto time = fs::last_write_time(file, error).time_since_epoch().count();
  return fmt::format("{} {} {}\n", file.string(), fs::file_size(file, error), time);
}

// Changes when one of the views or links would be another.
std::string IdentityOf(const std::vector<PanoramaJob>& jobs, const PanoramaOptions& options, const CutPhotos& now, const input::PhotoSet& photos) {
  std::string text = fmt::format("views of panoramas, form 1\n{} {} {} {}", options.per_ring, options.fov_deg, options.width, options.nadir_mask_deg);
  for (const double pitch_deg : options.pitches_deg) text += fmt::format(" {}", pitch_deg);
  text += "\n" + now.masks.string() + "\n";
  std::set<std::string> cut;
  for (const PanoramaJob& job : jobs) {
    cut.insert(job.photo.name);
    text += "cut " + FileText(now.picture_root / job.photo.name);
    if (!job.photo.mask.empty()) text += "mask " + FileText(job.photo.mask);
    // A file beside the photos may say where they are.
    if (const auto& gps = job.photo.tags.gps) text += fmt::format("{} {} {}\n", gps->latitude_deg, gps->longitude_deg, gps->height_m);
  }
  for (const input::PhotoFile& photo : photos.usable) {
    if (!cut.contains(photo.name)) text += "link " + FileText(now.picture_root / photo.name);
  }
  return text;
}

// What the views were made of, and what is known of them.
struct Plan {
  std::string made_from;
  bool complete = false;
  std::map<std::string, double> masked;           // share of each view
  std::map<std::string, std::string> unreadable;  // panoramas with their problems
};

Plan ReadPlan(const fs::path& file, const std::string& identity) {
  Plan plan{.made_from = identity};
  if (!fs::exists(file)) return plan;
  try {
    const nlohmann::json json = base::ParseJson(base::ReadFile(file));
    if (json.at("made_from").get<std::string>() != identity) return plan;
    plan.masked = json.at("masked").get<std::map<std::string, double>>();
    plan.unreadable = json.at("unreadable").get<std::map<std::string, std::string>>();
    plan.complete = json.at("complete").get<bool>();
  } catch (const nlohmann::json::exception&) {
    // Whatever it is, it is made anew.
    plan = {.made_from = identity};
  }
  return plan;
}

void WritePlan(const Plan& plan, const fs::path& file) {
  const nlohmann::ordered_json json = {
      {"made_from", plan.made_from}, {"complete", plan.complete}, {"masked", plan.masked}, {"unreadable", plan.unreadable}};
  base::WriteFileAtomically(file, base::JsonText(json, 1) + "\n");
}

bool WasMadeFrom(const fs::path& file, const std::string& identity) {
  if (!fs::exists(file)) return false;
  const nlohmann::json json = base::TryParseJson(base::ReadFile(file));
  const auto made_from = json.is_object() ? json.find("made_from") : json.end();
  return made_from != json.end() && made_from->is_string() && made_from->get<std::string>() == identity;
}

bool IsTaken(const Plan& plan, const PanoramaJob& job, size_t view) {
  const auto share = plan.masked.find(job.names[view]);
  return !plan.unreadable.contains(job.photo.name) && (share == plan.masked.end() || share->second <= kMostMasked);
}

bool AllAreThere(const Plan& plan, const std::vector<PanoramaJob>& jobs, const fs::path& folder) {
  if (!plan.complete || !fs::exists(folder / kTableName)) return false;
  for (const PanoramaJob& job : jobs) {
    for (size_t i = 0; i < job.names.size(); ++i) {
      if (IsTaken(plan, job, i) && !fs::exists(folder / kViewsName / job.names[i])) return false;
    }
  }
  return true;
}

// Hidden files that a killed process has left.
void RemoveUnfinished(const fs::path& views) {
  std::vector<fs::path> unfinished;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(views)) {
    if (entry.is_regular_file() && entry.path().filename().string().starts_with('.')) unfinished.push_back(entry.path());
  }
  for (const fs::path& file : unfinished) fs::remove(file);
}

// A file system without links gets a copy.
void Link(const fs::path& original, const fs::path& link) {
  if (fs::exists(link)) return;
  fs::create_directories(link.parent_path());
  std::error_code error;
  fs::create_symlink(fs::absolute(original), link, error);
  if (error) fs::copy_file(original, link, fs::copy_options::overwrite_existing, error);
  if (error) throw base::InputError(link, "cannot be written: " + error.message(), "Check free space and permissions of the output folder");
}

std::string TableOf(const Plan& plan, const std::vector<PanoramaJob>& jobs, const std::vector<PanoramaView>& views, double fov_deg) {
  using tables::CsvNumber;
  using tables::CsvText;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::string text =
      "view,panorama,taken,reason,yaw_deg,pitch_deg,fov_deg,width,masked_share,latitude_deg,longitude_deg,altitude_m,gimbal_yaw_deg,gimbal_pitch_deg,"
      "gimbal_roll_deg\n";
  for (const PanoramaJob& job : jobs) {
    for (size_t i = 0; i < views.size(); ++i) {
      const bool taken = IsTaken(plan, job, i);
      const auto unreadable = plan.unreadable.find(job.photo.name);
      const auto share = plan.masked.find(job.names[i]);
      const double masked = share == plan.masked.end() ? kUnknown : share->second;
      const std::string reason = unreadable != plan.unreadable.end() ? unreadable->second
                                 : taken                             ? ""
                                         : fmt::format("{:.0f} % of it are masked or not in the panorama", 100.0 * masked);
      const survey::PhotoTags tags = TagsOfView(job.photo.tags, views[i], job.camera.width, job.camera.FocalX());
      text += CsvText(job.names[i]) + "," + CsvText(job.photo.name) + (taken ? ",yes," : ",no,") + CsvText(reason) + "," +
              CsvNumber(views[i].yaw_deg, 3) + "," + CsvNumber(views[i].pitch_deg, 3) + "," + CsvNumber(fov_deg, 3) + "," +
              std::to_string(job.camera.width) + "," + CsvNumber(masked, 4) + "," + CsvNumber(tags.gps ? tags.gps->latitude_deg : kUnknown, 8) + "," +
              CsvNumber(tags.gps ? tags.gps->longitude_deg : kUnknown, 8) + "," + CsvNumber(tags.gps ? tags.gps->height_m : kUnknown, 3) + "," +
              CsvNumber(tags.gimbal_yaw_deg.value_or(kUnknown), 2) + "," + CsvNumber(tags.gimbal_pitch_deg.value_or(kUnknown), 2) + "," +
              CsvNumber(tags.gimbal_roll_deg.value_or(kUnknown), 2) + "\n";
    }
  }
  return text;
}

Rig RigWithLenses(const std::vector<PanoramaJob>& jobs, const std::vector<PanoramaView>& views) {
  Rig rig = RigOf(views);
  const camera::Camera& camera = jobs.front().camera;
  const bool one_lens = std::all_of(jobs.begin(), jobs.end(), [&](const PanoramaJob& job) { return job.camera.width == camera.width; });
  if (!one_lens) return rig;
  for (RigCamera& one : rig.cameras) {
    one.model = camera::ModelName(camera.model);
    one.params = camera.params;
  }
  return rig;
}

// The views of all panoramas as photos.
std::vector<input::PhotoFile> ViewsAsPhotos(const Plan& plan, const std::vector<PanoramaJob>& jobs, const std::vector<PanoramaView>& views,
                                            const fs::path& folder) {
  const Rig rig = RigOf(views);
  std::vector<input::PhotoFile> photos;
  for (const PanoramaJob& job : jobs) {
    for (size_t i = 0; i < views.size(); ++i) {
      if (!IsTaken(plan, job, i)) continue;
      input::PhotoFile& photo = photos.emplace_back();
      photo.name = job.names[i];
      photo.width = photo.height = job.camera.width;
      photo.tags = TagsOfView(job.photo.tags, views[i], job.camera.width, job.camera.FocalX());
      const auto share = plan.masked.find(photo.name);
      if (share != plan.masked.end() && share->second > 0.0) photo.mask = (folder / kMasksName / (photo.name + ".png")).string();
      photo.rig = input::RigPlace{.rig = (folder / kViewsName / kRigName).string(),
                                  .shot = job.photo.name,
                                  .camera = views[i].prefix,
                                  .cam_from_rig = rig.cameras[i].cam_from_rig,
                                  .exact_focal_px = job.camera.FocalX()};
    }
  }
  return photos;
}

void WriteAll(const std::vector<PanoramaJob>& jobs, const std::vector<PanoramaView>& views, double nadir_deg, const ViewFolders& folders, Plan& plan,
              base::ThreadPool& threads) {
  base::Progress progress("cut panoramas", static_cast<double>(jobs.size()), "panoramas");
  for (const PanoramaJob& job : jobs) {
    try {
      WriteViews(job, views, nadir_deg, folders, &plan.masked, threads);
    } catch (const base::InputError& error) {
      // Of the output it concerns all.
      if (error.file() != folders.panoramas / job.photo.name) throw;
      plan.unreadable.emplace(job.photo.name, error.what());
    }
    progress.Advance();
  }
  progress.Finish();
}

}  // namespace

std::vector<size_t> FindPanoramas(const std::vector<input::PhotoFile>& photos, const std::string& which) {
  std::vector<size_t> panoramas;
  size_t n_say = 0, n_shape = 0;
  std::string example;
  for (size_t i = 0; i < photos.size(); ++i) {
    const bool says = SaysPanorama(photos[i]), shape = !says && HasShapeOfPanorama(photos[i]);
    n_say += says ? 1 : 0;
    n_shape += shape ? 1 : 0;
    if (shape && example.empty()) example = photos[i].name;
    if ((says && which != "none") || (shape && which == "all")) panoramas.push_back(i);
  }
  if (which == "none" && n_say > 0)
    base::LogWarning("{} photos are panoramas by their tags, but prepare.panoramas = none takes them for photos", n_say);
  if (which == "auto" && n_shape > 0) {
    base::LogInfo(
        "{} photos are twice as wide as high, such as {}, and have no tag that they are panoramas: taken for photos. If they are panoramas, add "
        "--panoramas",
        n_shape, example);
  }
  return panoramas;
}

void CutPanoramas(const std::vector<size_t>& panoramas, const PanoramaOptions& options, const fs::path& out, CutPhotos& now, input::PhotoSet& photos,
                  base::ThreadPool& threads) {
  const fs::path folder = fs::absolute(out);
  if (panoramas.empty()) {
    for (const char* name : {kTableName, kPlanName}) fs::remove(folder / name);
    for (const char* name : {kViewsName, kMasksName}) fs::remove_all(folder / name);
    return;
  }
  const std::vector<PanoramaView> views = LayOutViews(options.per_ring, options.pitches_deg);
  const std::vector<PanoramaJob> jobs = JobsOf(panoramas, options, views, photos);
  const ViewFolders folders{.panoramas = now.picture_root, .pictures = folder / kViewsName, .masks = folder / kMasksName};
  const std::string identity = IdentityOf(jobs, options, now, photos);
  Plan plan = ReadPlan(folder / kPlanName, identity);
  if (AllAreThere(plan, jobs, folder)) {
    base::LogInfo("{} panoramas are already cut, in {}", jobs.size(), folders.pictures.string());
  } else {
    fs::remove(folder / kTableName);
    if (!WasMadeFrom(folder / kPlanName, identity)) {
      // Views of other panoramas or options may have the same names.
      fs::remove(folder / kPlanName);
      fs::remove_all(folders.pictures);
      fs::remove_all(folders.masks);
    }
    base::RequireWritableFolder(folders.pictures);
    plan = {.made_from = identity};
    WritePlan(plan, folder / kPlanName);
    RemoveUnfinished(folders.pictures);
    WriteAll(jobs, views, options.nadir_mask_deg, folders, plan, threads);
    base::WriteFileAtomically(folders.pictures / kRigName, RigConfigText({RigWithLenses(jobs, views)}));
    plan.complete = true;
    WritePlan(plan, folder / kPlanName);
    base::WriteFileAtomically(folder / kTableName, TableOf(plan, jobs, views, options.fov_deg));
  }

  std::set<std::string> cut;
  for (const PanoramaJob& job : jobs) cut.insert(job.photo.name);
  std::erase_if(photos.usable, [&](const input::PhotoFile& photo) { return cut.contains(photo.name); });
  bool any_mask = false;
  for (input::PhotoFile& photo : photos.usable) {
    Link(now.picture_root / photo.name, folders.pictures / photo.name);
    if (photo.mask.empty()) continue;
    const fs::path mask = folders.masks / (photo.name + ".png");
    Link(photo.mask, mask);
    photo.mask = mask.string();
    any_mask = true;
  }
  const size_t n_others = photos.usable.size();
  for (const auto& [name, problem] : plan.unreadable) {
    base::LogWarning("panorama left out: {}", problem);
    photos.unreadable.push_back(name);
  }
  for (input::PhotoFile& view : ViewsAsPhotos(plan, jobs, views, folder)) {
    any_mask = any_mask || !view.mask.empty();
    photos.usable.push_back(std::move(view));
  }
  std::sort(photos.usable.begin(), photos.usable.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  now = {folders.pictures, any_mask ? folders.masks : fs::path()};
  const size_t n_views = photos.usable.size() - n_others;
  base::LogInfo("{} panoramas became {} views of {:g} degrees{}; {} lists them", jobs.size() - plan.unreadable.size(), n_views, options.fov_deg,
                n_others > 0 ? fmt::format("; {} other photos stay as they are", n_others) : "", (folder / kTableName).string());
  if (photos.usable.size() < static_cast<size_t>(input::kMinPhotos)) {
    throw base::InputError(folder / kTableName, fmt::format("lists {} views that can be used", n_views),
                           "Masks hide the others: make prepare.nadir_mask_deg smaller, or see the masks of the panoramas");
  }
}

}  // namespace skyquilt::prepare::rigs
