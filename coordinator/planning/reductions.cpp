#include "coordinator/planning/reductions.h"

#include <fmt/core.h>

#include <algorithm>

namespace skyquilt::coordinator {
namespace {

class ReductionList {
 public:
  ReductionList(const Settings& settings, const WorkSize& size) : settings_(settings), size_(size) {}

  std::vector<Reduction> Make() {
    AddVideo();
    if (settings_.evaluate.field_normals) {
      Add("normals", "evaluate", "normals of the field are not scored (evaluate.field_normals)", {{"evaluate.field_normals", "false"}});
    }
    for (const int most : {24, 12, 6}) AddScoredPhotos(most);
    if (settings_.surface.enabled && settings_.surface.virtual_views) {
      Add("gap views", "surface", "no virtual views of what photos leave out (surface.virtual_views)", {{"surface.virtual_views", "false"}});
    }
    if (settings_.surface.enabled && settings_.surface.refine) {
      Add("depths by photos", "surface", "depths are not improved by comparing photos (surface.refine)", {{"surface.refine", "false"}});
    }
    AddMaps(FineCells());
    AddSurfaceDetail(2.5, 3.0, 2.0);
    if (settings_.tour.auto_stops > 0) Add("tour", "tour", "no tour (tour.auto)", {{"tour.auto", "0"}});
    for (const int width : {1000, 800, 640}) AddWidth(width);
    AddMaps({2.0, 3.0});
    if (settings_.products.preview) {
      Add("previews", "train", "no picture of the context before the orthophoto (products.preview)", {{"products.preview", "false"}});
    }
    if (!size_.poses_given) {
      AddFeatures(2048, 1200);
      AddFeatures(1024, 1000);
    }
    AddFiles();
    AddSurfaceDetail(4.0, 5.0, 4.0);
    AddScoredPhotos(2);
    if (settings_.buildings.enabled && settings_.surface.enabled) {
      Add("buildings", "buildings", "no buildings are measured (buildings.enabled)", {{"buildings.enabled", "false"}});
    }
    if (settings_.surface.enabled) {
      Add("surface", "surface", "no mesh, cloud, tiles, terrain and buildings (surface.enabled)", {{"surface.enabled", "false"}});
    }
    return std::move(list_);
  }

 private:
  void Add(const std::string& what, const std::string& stage, std::string text, std::vector<config::Override> changes) {
    list_.push_back({what, stage, std::move(text), std::move(changes)});
  }

  void AddVideo() {
    const double seconds = settings_.products.video_seconds;
    if (seconds > 2.0) Add("video", "products", fmt::format("a video of 2 s instead of {:g} s", seconds), {{"products.video_seconds", "2"}});
    if (seconds > 0.0) Add("video", "products", "no video (products.video_seconds)", {{"products.video_seconds", "0"}});
  }

  // Cells of 1.5 and 2 pixels of the full photos, where these are finer than those of the scene, then one pixel at the training width.
  std::vector<double> FineCells() const {
    std::vector<double> cells;
    const double full = size_.GsdAt(0) / std::max(1e-9, size_.GsdAt(settings_.run.image_width));
    for (const double pixels : {1.5, 2.0}) {
      if (settings_.products.ortho_source == "photos" && pixels * full < 1.0) cells.push_back(pixels * full);
    }
    cells.push_back(1.0);
    return cells;
  }

  // Cells of so many pixels at the training width. Their size is known when there is a survey.
  void AddMaps(const std::vector<double>& cells) {
    if (size_.level || !(size_.photo_gsd_m > 0.0) || !(settings_.products.ortho || settings_.products.dsm)) return;
    for (const double pixels : cells) {
      const std::string cell = fmt::format("{:.3g}", pixels * size_.GsdAt(settings_.run.image_width));
      if (settings_.products.resolution_m >= std::stod(cell)) continue;
      Add("maps", "products", fmt::format("maps with cells of {} m (products.resolution_m)", cell), {{"products.resolution_m", cell}});
    }
  }

  void AddSurfaceDetail(double voxel, double view, double texel) {
    const surface::SurfaceOptions& options = settings_.surface;
    if (!options.enabled) return;
    std::vector<config::Override> changes;
    const auto larger = [&changes](const char* key, double now, double value) {
      if (value > now) changes.push_back({key, fmt::format("{:g}", value)});
    };
    larger("surface.voxel_gsd", options.voxel_gsd, voxel);
    larger("surface.view_gsd", options.view_gsd, view);
    larger("surface.texel_gsd", options.texel_gsd, texel);
    if (changes.empty()) return;
    Add("surface detail", "surface",
        fmt::format("a coarser surface: voxels of {:g}, views of {:g} and texels of {:g} ground sampling distances",
                    std::max(voxel, options.voxel_gsd), std::max(view, options.view_gsd), std::max(texel, options.texel_gsd)),
        std::move(changes));
  }

  void AddFiles() {
    const surface::SurfaceOptions& options = settings_.surface;
    if (!options.enabled || !(options.obj || options.ply)) return;
    Add("files", "surface", "no mesh.obj and mesh.ply beside mesh.glb", {{"surface.obj", "false"}, {"surface.ply", "false"}});
  }

  void AddScoredPhotos(int most) {
    const evaluate::EvaluateOptions& options = settings_.evaluate;
    const int now = options.max_photos > 0 ? std::min(options.max_photos, size_.held_out) : size_.held_out;
    if (now <= most) return;
    const std::string n = std::to_string(most);
    std::vector<config::Override> changes = {{"evaluate.max_photos", n}};
    if (options.report_photos > most) changes.push_back({"evaluate.report_photos", n});
    Add("scores", "evaluate", fmt::format("{} of {} held-out photos are scored (evaluate.max_photos)", most, now), std::move(changes));
  }

  void AddWidth(int width) {
    const int photo = size_.photo_width > 0 ? size_.photo_width : width + 1;
    const int now = settings_.run.image_width > 0 ? std::min(settings_.run.image_width, photo) : photo;
    if (now <= width) return;
    Add("width", "partition", fmt::format("photos are reduced to a width of {} instead of {} pixels (run.image_width)", width, now),
        {{"run.image_width", std::to_string(width)}});
  }

  void AddFeatures(int features, int image_size) {
    const prepare::PrepareOptions& options = settings_.prepare;
    std::vector<config::Override> changes;
    if (options.max_features > features) changes.push_back({"prepare.max_features", std::to_string(features)});
    if (options.max_image_size > image_size) changes.push_back({"prepare.max_image_size", std::to_string(image_size)});
    if (changes.empty()) return;
    Add("features", "prepare", fmt::format("at most {} features per photo, searched at {} pixels (prepare.max_features)", features, image_size),
        std::move(changes));
  }

  const Settings& settings_;
  const WorkSize& size_;
  std::vector<Reduction> list_;
};

}  // namespace

std::vector<Reduction> ReductionsOf(const Settings& settings, const WorkSize& size) {
  return ReductionList(settings, size).Make();
}

void Apply(const Reduction& reduction, Settings* settings) {
  for (const config::Override& change : reduction.changes) settings->Set(change);
}

std::vector<std::string> TextsOf(const std::vector<Reduction>& reductions) {
  std::vector<std::string> texts;
  for (size_t i = 0; i < reductions.size(); ++i) {
    const bool last = std::none_of(reductions.begin() + static_cast<std::ptrdiff_t>(i) + 1, reductions.end(),
                                   [&](const Reduction& later) { return later.what == reductions[i].what; });
    if (last) texts.push_back(reductions[i].text);
  }
  return texts;
}

}  // namespace skyquilt::coordinator
