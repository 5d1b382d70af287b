#include "tour/export/export_tour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/system.h"
#include "core/image/image.h"
#include "core/image/srgb.h"
#include "tour/export/disk_space.h"
#include "tour/export/embed_page.h"
#include "tour/export/export_plan.h"
#include "tour/export/script_data.h"
#include "tour/export/staged_folder.h"
#include "tour/format/tour_file.h"
#include "tour/pictures/estimate_seconds.h"
#include "tour/pictures/make_pictures.h"

namespace skyquilt::tour {
namespace {

namespace fs = std::filesystem;

constexpr int kPosterWidth = 1200, kPosterQuality = 85;
// Of rendered pictures in the work folder: PNG and depth take less.
constexpr int kWorkBytesPerRay = 3;
// Fewer are rendered about as fast as their time is estimated.
constexpr int64_t kRaysWorthAnEstimate = 1'000'000;
// For manifest.json beside its list of stops, whose length is known only when they are written.
constexpr int64_t kManifestBytes = 2000, kManifestBytesPerStop = 400;

std::vector<PictureRequest> RequestsOf(const Tour& tour, const ExportInput& input) {
  const TourOptions& options = input.options;
  std::vector<PictureRequest> requests;
  for (const Stop& stop : tour.stops) {
    // The page brightens what it shows at the stop, the surface as well as its pictures.
    const std::string exposure = stop.exposure_stops ? "normal" : input.exposure;
    const Pose& pose = stop.pose;
    requests.push_back(StillAt(pose.eye_enu, pose.cam_from_enu, pose.fovy_deg, options.still_width, options.still_height, exposure));
    requests.push_back(PanoramaAt(pose.eye_enu, options.panorama_width, exposure));
  }
  return requests;
}

// Stills and panoramas of all stops, rendered as far as they are not there yet.
std::vector<StopPictures> RenderPictures(const Tour& tour, const ExportInput& input, const PictureField& field) {
  const std::vector<PictureRequest> requests = RequestsOf(tour, input);
  const std::vector<PictureRequest> missing = MissingPictures(requests, field, input.work);
  if (!missing.empty()) {
    int64_t rays = 0;
    for (const PictureRequest& request : missing) rays += request.Rays();
    RequireFreeSpace(input.work, kWorkBytesPerRay * rays, "pictures of the tour");
    if (rays >= kRaysWorthAnEstimate) {
      base::LogInfo("pictures of the tour: {} to render, about {}", missing.size(), base::FormatDuration(EstimateSeconds(missing, field)));
    }
  }
  const PictureFiles result = MakePictures(requests, field, input.work);
  std::vector<StopPictures> pictures;
  for (size_t i = 0; i < tour.stops.size(); ++i) pictures.push_back({tour.stops[i].id, result.files[2 * i], result.files[2 * i + 1]});
  return pictures;
}

const Stop& FirstStop(const Tour& tour) {
  const auto start = std::find_if(tour.stops.begin(), tour.stops.end(), [&](const Stop& stop) { return tour.start == stop.id; });
  return start != tour.stops.end() ? *start : tour.stops.front();
}

// tour.json is as it was saved, so that the page has to be told which of its assets are there.
std::vector<std::string> FileNames(const FixedFiles& fixed) {
  std::vector<std::string> names;
  for (const auto& [name, content] : fixed.contents) names.push_back(name);
  for (const auto& [name, file] : fixed.files) names.push_back(name);
  return names;
}

// In linear light, as the page does it and `render --exposure`.
void Brighten(double stops, image::Image8* picture) {
  if (stops == 0.0) return;
  const float gain = std::exp2(static_cast<float>(stops));
  std::array<uint8_t, 256> shown{};
  for (size_t i = 0; i < shown.size(); ++i) {
    const float value = image::SrgbFromLinear(gain * image::LinearFromSrgb(static_cast<float>(i) / 255.0F));
    shown[i] = static_cast<uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
  }
  for (uint8_t& value : picture->data) value = shown[value];
}

std::string PosterOf(const Tour& tour, const std::vector<StopPictures>& pictures) {
  const std::string& id = FirstStop(tour).id;
  const auto first = std::find_if(pictures.begin(), pictures.end(), [&](const StopPictures& one) { return one.stop == id; });
  const image::Image8 still = ColorsOf(OpenPicture(first->still));
  const int width = std::min(kPosterWidth, still.width);
  image::Image8 poster = image::Resize(still, width, image::ScaledHeight(still.width, still.height, width));
  Brighten(FirstStop(tour).exposure_stops.value_or(0.0), &poster);
  const std::vector<uint8_t> jpeg = image::EncodeJpeg(poster, kPosterQuality);
  return {jpeg.begin(), jpeg.end()};
}

std::string ManifestText(const ExportParts& parts, const FixedFiles& fixed, const std::vector<std::string>& missing, nlohmann::json stops) {
  nlohmann::json manifest = {
      {"version", 1}, {"missing", missing}, {"stops", std::move(stops)}, {"made_by", parts.made_by}, {"date", base::UtcTimestamp()}};
  manifest["files"] = FileNames(fixed);
  return base::JsonText(manifest);
}

int64_t SizeOf(const std::string& text) {
  return static_cast<int64_t>(text.size());
}

void LogPlan(const ExportPlan& plan, const TileTree* tree, const TourOptions& options) {
  if (plan.pictures.shrink > 1) {
    base::LogWarning("panoramas are {} pixels wide instead of {}, so that the tour fits into {}. Give a larger --size for more",
                     options.panorama_width / plan.pictures.shrink, options.panorama_width, MegabytesText(options.SizeBytes()));
  }
  base::LogDebug("pictures: JPEG quality {}, stills {}, {}", plan.pictures.quality, plan.pictures.lossless_stills ? "PNG" : "JPEG",
                 MegabytesText(plan.pictures.bytes));
  if (tree == nullptr) return;
  const TileTree::Choice all = tree->All();
  if (plan.tiles->tiles == all.tiles) return;
  base::LogInfo("surface: {} of {} pieces fit; {} of finer ones far from the stops are left out. Give a larger --size for more", plan.tiles->tiles,
                all.tiles, MegabytesText(all.bytes - plan.tiles->bytes));
}

int64_t BytesIn(const fs::path& folder) {
  int64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) bytes += static_cast<int64_t>(entry.file_size());
  }
  return bytes;
}

// All data, into the folder.
void WriteFiles(const ExportParts& parts, const FixedFiles& fixed, const ExportPlan& plan, const TileTree* tree,
                const std::vector<StopPictures>& pictures, const std::vector<std::string>& missing, const fs::path& folder) {
  const fs::path data = folder / "data";
  base::Progress progress("tour", static_cast<double>(plan.bytes - BytesIn(folder)), "B");
  const auto done = [&progress](int64_t bytes) { progress.Advance(static_cast<double>(bytes)); };
  for (const auto& [name, content] : fixed.contents) done(WriteScript(data, name, content));
  for (const auto& [name, file] : fixed.files) done(WriteScriptOf(data, name, file));
  nlohmann::json stops = WritePicturesOfStops(pictures, plan.pictures, data, done);
  done(WriteScript(data, "manifest.json", ManifestText(parts, fixed, missing, std::move(stops))));
  if (tree != nullptr) {
    done(WriteScript(data, TileTree::DataName("tileset.json"), tree->Text(*plan.tiles)));
    for (size_t i = 0; i < tree->nodes().size(); ++i) {
      const TileTree::Node& node = tree->nodes()[i];
      if (plan.tiles->kept[i] && !node.file.empty()) done(WriteScriptOf(data, TileTree::DataName(node.file), parts.tiles / node.file));
    }
  }
  progress.Finish();
}

}  // namespace

Exported ExportTour(const ExportInput& input, const ExportParts& parts, const PictureField& field, base::ThreadPool& threads) {
  const TourContent content = ReadContent(input.project);
  const Tour& tour = content.playable.tour;
  std::set<std::string> expected;
  if (fs::absolute(input.out).lexically_normal() == AssetFolder(fs::absolute(input.project).lexically_normal()).parent_path()) {
    expected = {"assets", "work"};
  }
  // Before minutes of rendering.
  StagedFolder staged(input.out, expected);
  const FixedFiles fixed = CollectFixedFiles(input, parts, content);
  std::optional<TileTree> tree;
  if (!parts.tiles.empty()) tree.emplace(parts.tiles);
  std::vector<std::string> missing = content.playable.missing;
  if (!tree) missing.emplace_back("The textured surface is not there: between the stops only the surface model is shown.");
  for (const std::string& sentence : missing) base::LogWarning("{}", sentence);

  const std::vector<StopPictures> pictures = RenderPictures(tour, input, field);
  if (input.make_video) input.make_video(tour, staged.partial() / "tour.mp4");
  base::WriteFileAtomically(staged.partial() / "poster.jpg", PosterOf(tour, pictures));
  base::WriteFileAtomically(staged.partial() / "embed.html", EmbedPage(tour.title));
  for (const PageFile& file : parts.page) base::WriteFileAtomically(staged.partial() / file.name, file.content);

  int64_t sentences = kManifestBytes + kManifestBytesPerStop * static_cast<int64_t>(tour.stops.size());
  for (const std::string& sentence : missing) sentences += 2 * SizeOf(sentence);
  for (const std::string& name : FileNames(fixed)) sentences += 2 * SizeOf(name);
  const int64_t other = BytesIn(staged.partial()) + fixed.Bytes() + ScriptBytes("manifest.json", sentences);
  const ExportPlan plan = PlanExport(input.out, input.options.SizeBytes(), other, pictures, tree ? &*tree : nullptr, tour, threads);
  LogPlan(plan, tree ? &*tree : nullptr, input.options);
  RequireFreeSpace(staged.partial(), plan.bytes, "the tour");
  WriteFiles(parts, fixed, plan, tree ? &*tree : nullptr, pictures, missing, staged.partial());
  base::ThrowIfCancelled();

  Exported exported;
  exported.bytes = BytesIn(staged.partial());
  SKYQUILT_CHECK(exported.bytes <= input.options.SizeBytes(), std::to_string(exported.bytes));
  exported.stops = tour.stops.size();
  if (tree) {
    exported.tiles = plan.tiles->tiles;
    exported.tiles_of = tree->All().tiles;
  }
  exported.missing = missing;
  staged.Publish();
  return exported;
}

}  // namespace skyquilt::tour
