#include "coordinator/planning/predictor.h"

#include <algorithm>
#include <cmath>

#include "products/map_products.h"
#include "worker/train_options.h"

namespace skyquilt::coordinator {
namespace {

// Where no comment says otherwise, fitted to the stages' times in docs/benchmarks.md ("Poses", "Surface", "Buildings"), two threads.
constexpr double kPairsPerPhoto = 8.4;   // Seneca, Brighton Beach and simulated flights have 7.9 to 8.5
constexpr double kAllPairsBelow = 30.0;  // photos; prepare::poses::PairRules
constexpr double kVerifiedPairs = 75.0;  // per second and thread
constexpr double kPlacedPhotos = 5.0;    // per second and thread: poses by tags and matches, adjustment
constexpr double kUntaggedPoses = 3.0;   // times as long: more pairs, COLMAP's mapper
constexpr double kFirstPicture_s = 2.0;
constexpr double kStageStart_s = 1.0;  // reading survey and scene, writing small files
// As fast as rays from a photo, which are measured: of map cells, and of a video's pictures, which look farther. Town, orbit, Brighton Beach.
constexpr double kMapRays = 1.0, kVideoRays = 0.75;
constexpr double kMostFineMapCells = 8e6;                              // as in products/map_products.cpp
constexpr double kFineMapRays = 0.5;                                   // of their cells that get a ray (products/map_cells.h)
constexpr double kPixelsPerTrustRay = 16.0, kMostTrustTiles = 1500.0;  // as in evaluate/trust/measure_trust.cpp
constexpr double kTexelLevels = 4.0 / 3.0;                             // coarser tiles have a quarter of the texels each
constexpr double kPhotoTexels = 0.5;                                   // time of a texel from photos, in texels from the field
constexpr double kCoarseViews = 0.28;      // pixels of coarse pictures of depth with their virtual ones, in those of photos (surface/fuse_mesh.cpp)
constexpr double kFilledMesh = 1.3;        // time of fusion with the coarse meshes, in that without
constexpr double kWallShare = 1.3;         // surface per ground
constexpr double kRefinedWidth = 640.0;    // pixels across a picture of depth whose depths photos improve
constexpr double kMatchedPixels = 0.13e6;  // of pictures of depth, compared with photos, per second and thread
constexpr double kMeshCells = 0.12e6;      // voxels of the surface per second and thread
constexpr double kLevelMesh = 2.0;         // times as long: walls, trees and what they hide
constexpr double kReportPhotos = 3.0;      // pictures of a photo written per second and thread
constexpr double kBuildingCells = 0.2e6;   // cells of the surface per second and thread
constexpr double kMeshScores = 1.0;        // comparing the mesh with a photo, too: as long as comparing the field
constexpr double kTruthScores_s = 6.0;
constexpr double kDepthPictureRays = 64.0 * 48.0;
// Seconds per photo and thread of stage "masks", guessed: networks differ by far more than machines.
constexpr double kNetworkMask_s = 1.0, kGroundMask_s = 0.4;
constexpr double kMostCorrection = 6.0;
constexpr double kOwnShare = 0.7, kOtherShare = 0.3;  // of the logarithm of a stage's ratio
constexpr double kLeastTold_s = 1.0;

double Squared(double x) {
  return x * x;
}

}  // namespace

Predictor::Kind Predictor::KindOf(const std::string& stage) {
  if (stage == "prepare") return kPoses;
  if (stage == "products") return kMaps;
  return stage == "surface" || stage == "buildings" || stage == "tour" || stage == "evaluate" ? kRendering : kOther;
}

double Predictor::RaySeconds(double rays) const {
  return rays / (std::max(1.0, rates_.rays) * size_.Speedup());
}

double Predictor::DecodingSeconds(const Settings& settings) const {
  // The decoder leaves detail out that the training width does not need, which saves a part.
  const double share = settings.run.image_width > 0 && 2 * settings.run.image_width <= size_.photo_width ? 0.5 : 1.0;
  return kStageStart_s + share * size_.photos * size_.photo_pixels / std::max(1.0, rates_.decoded_pixels);
}

double Predictor::PrepareSeconds(const Settings& settings) const {
  const double n = size_.photos;
  // Every file is read and checked.
  double seconds = kStageStart_s + n / (100.0 * size_.threads) + (settings.products.preview && !size_.level ? kFirstPicture_s : 0.0);
  if (size_.poses_given) return seconds + n / (20.0 * size_.threads);
  const double speedup = size_.Speedup();
  const double searched = size_.PixelsAt(std::min(settings.prepare.max_image_size, std::max(1, size_.photo_width)));
  seconds += n * searched / (std::max(1.0, rates_.feature_pixels) * speedup);
  const double most = std::min(n, kAllPairsBelow - 1.0);
  const double pairs = std::max(0.5 * most * (most - 1.0), n < kAllPairsBelow ? 0.0 : kPairsPerPhoto * n);
  const double features = std::min(4096, settings.prepare.max_features);
  double matching = pairs * Squared(features / 4096.0) / (std::max(1e-3, rates_.matched_pairs) * speedup);
  matching += pairs / (kVerifiedPairs * size_.threads) + n / (kPlacedPhotos * size_.threads);
  if (!size_.tagged || settings.prepare.poses == "colmap") matching *= kUntaggedPoses;
  return seconds + matching;
}

double Predictor::TrainSeconds(const Settings& settings) const {
  const double decoding = DecodingSeconds(settings);
  if (settings.run.time_budget_s > 0.0) return decoding + settings.run.time_budget_s;
  const double workers = size_.ranks > 1 ? std::min(size_.ranks - 1, size_.blocks) : 1;
  if (settings.train.steps == 0 && settings.train.seconds > 0.0) {
    return decoding + settings.context.seconds + size_.blocks * settings.train.seconds / workers;
  }
  const double steps = settings.train.steps > 0 ? settings.train.steps : worker::kDefaultSteps;
  const double context = settings.context.steps > 0 ? settings.context.steps : settings.train.steps > 0 ? std::max(200.0, 0.5 * steps) : steps;
  const double rate = std::max(1.0, rates_.samples);
  // Ranks of one machine share its threads.
  return decoding + context * settings.context.batch_samples / rate + size_.blocks * steps * settings.train.batch_samples / (rate * size_.Speedup());
}

double Predictor::ProductsSeconds(const Settings& settings) const {
  const products::ProductOptions& options = settings.products;
  const int width = settings.run.image_width;
  double seconds = kStageStart_s;
  if (!size_.level && (options.ortho || options.dsm)) {
    const bool from_photos = options.ortho && options.ortho_source == "photos";
    const double detail = size_.SurfacePixelsAt(width);  // cells of the scene's own detail
    // Cells of the resolution that is asked for, where the scene's own is known.
    const double asked = options.resolution_m > 0.0 ? detail * Squared(size_.GsdAt(width) / options.resolution_m) : 0.0;
    double cells = from_photos && 4.0 * detail <= kMostFineMapCells ? 4.0 * detail : std::min(detail, products::kMostRenderedCells);
    if (asked > 0.0) cells = from_photos ? std::min(cells, asked) : asked;
    seconds += RaySeconds((cells > detail ? kFineMapRays : 1.0) * cells / kMapRays);
    if (from_photos) {
      // Each pixel of each photo is a candidate for one cell; for fewer where cells are larger.
      const double painted = asked > 0.0 ? asked : std::min(size_.surface_pixels, products::kMostRenderedCells);
      const double pixels = size_.TrainingPhotos() * size_.photo_pixels;
      const double share = size_.surface_pixels > 0.0 ? std::min(1.0, painted / size_.surface_pixels) : 1.0;
      seconds += share * pixels / std::max(1.0, rates_.painted_pixels) + pixels / std::max(1.0, rates_.decoded_pixels);
    }
  }
  return seconds + RaySeconds(options.video_seconds * options.video_fps * options.video_width * options.video_height / kVideoRays);
}

double Predictor::TrustSeconds(const Settings& settings) const {
  if (!settings.trust.Measured()) return 0.0;
  const double pixels = size_.TrainingPhotos() * size_.PixelsAt(settings.run.image_width);
  return RaySeconds(std::min(settings.trust.rays, pixels / kPixelsPerTrustRay) + 256.0 * std::min(kMostTrustTiles, double{1} * settings.trust.tiles));
}

double Predictor::SurfaceSeconds(const Settings& settings) const {
  const surface::SurfaceOptions& options = settings.surface;
  if (!options.enabled) return 0.0;
  const double detail = kWallShare * size_.SurfacePixelsAt(settings.run.image_width);
  const double of_photos = size_.TrainingPhotos() * size_.PixelsAt(settings.run.image_width) / std::max(1.0, Squared(options.view_gsd));
  // Only pictures of depth that are wide enough are improved (surface/views/render_depth_views.cpp).
  const bool refined = options.refine && std::sqrt(4.0 / 3.0 * size_.PixelsAt(settings.run.image_width)) >= kRefinedWidth * options.view_gsd;
  const double views = of_photos * (options.virtual_views ? (refined ? 1.25 : 2.0) : 1.0);
  const bool filled = options.fill_gaps && !size_.level;
  const double texels = detail / Squared(options.texel_gsd) * (options.tiles ? kTexelLevels : 1.0) * (options.photo_texture ? kPhotoTexels : 1.0);
  const double fusion = views / std::max(1.0, rates_.fused_pixels) + detail / Squared(options.voxel_gsd) / (kMeshCells * size_.threads);
  const double matching = refined ? of_photos / (kMatchedPixels * size_.threads) : 0.0;
  const double slower = size_.level ? kLevelMesh : filled ? kFilledMesh : 1.0;
  return kStageStart_s + RaySeconds(views + (filled ? kCoarseViews * of_photos : 0.0)) + matching +
         texels / (std::max(1.0, rates_.texels) * size_.Speedup()) + slower * fusion;
}

double Predictor::MasksSeconds(const Settings& settings) const {
  const masks::MaskOptions& options = settings.masks;
  if (!options.Any()) return 0.0;
  const double per_photo = options.segment.empty() ? kGroundMask_s : kNetworkMask_s;
  return 0.3 * kStageStart_s + size_.photos * per_photo / (size_.threads * size_.Speedup());
}

double Predictor::TourSeconds(const Settings& settings) const {
  const tour::TourOptions& options = settings.tour;
  const double pixels = static_cast<double>(options.still_width) * options.still_height + 0.5 * Squared(options.panorama_width);
  return options.auto_stops > 0 ? kStageStart_s + RaySeconds(options.auto_stops * pixels) : 0.0;
}

double Predictor::EvaluateSeconds(const Settings& settings) const {
  const evaluate::EvaluateOptions& options = settings.evaluate;
  const int most = options.max_photos > 0 ? options.max_photos : size_.held_out;
  const double scored = std::min(most, size_.held_out);
  const double pixels = scored * size_.PixelsAt(options.image_width > 0 ? options.image_width : settings.run.image_width);
  const double pictures = std::min(scored, static_cast<double>(options.report_photos)) / (kReportPhotos * size_.threads);
  const double comparing = (settings.surface.enabled ? 1.0 + kMeshScores : 1.0) * pixels / std::max(1.0, rates_.scored_pixels);
  // Level photos count as covered only what no training photo's small picture of depth hides (evaluate/photos/training_depths.h).
  const double hiding = size_.level ? size_.TrainingPhotos() * kDepthPictureRays : 0.0;
  const double truth_s = size_.truth && settings.surface.enabled ? kTruthScores_s : 0.0;
  return 2.0 * kStageStart_s + pictures + RaySeconds(pixels * (options.field_normals ? 2.0 : 1.0) + hiding) + comparing + truth_s;
}

double Predictor::Seconds(const std::string& stage, const Settings& settings) const {
  const double factor = factors_[KindOf(stage)];
  if (stage == "prepare") return factor * PrepareSeconds(settings);
  if (stage == "train") return TrainSeconds(settings);
  if (stage == "products") return factor * ProductsSeconds(settings);
  if (stage == "surface") return factor * SurfaceSeconds(settings);
  if (stage == "tour") return factor * TourSeconds(settings);
  if (stage == "evaluate") return factor * EvaluateSeconds(settings);
  if (stage == "masks") return MasksSeconds(settings);
  if (stage == "partition") return 0.3 * kStageStart_s + size_.photos / 500.0;
  if (stage == "merge") return 0.3 * kStageStart_s + 0.2 * size_.blocks + factor * TrustSeconds(settings);
  if (stage == "buildings") {
    const surface::SurfaceOptions& surface = settings.surface;
    const bool made = settings.buildings.enabled && surface.enabled && surface.cloud && surface.maps && !size_.level;
    const double cells = size_.SurfacePixelsAt(settings.run.image_width) / Squared(surface.voxel_gsd);
    return made ? factor * (2.0 * kStageStart_s + cells / (kBuildingCells * size_.threads)) : 0.0;
  }
  return 0.0;
}

void Predictor::Correct(const std::string& stage, double predicted_s, double took_s) {
  const Kind kind = KindOf(stage);
  if (kind == kOther || !(predicted_s >= kLeastTold_s) || !(took_s >= kLeastTold_s)) return;
  const double ratio = took_s / predicted_s;
  for (size_t i = 0; i < kOther; ++i) {
    factors_[i] = std::clamp(factors_[i] * std::pow(ratio, i == kind ? kOwnShare : kOtherShare), 1.0 / kMostCorrection, kMostCorrection);
  }
}

void Predictor::TakeRays(double rays_per_second) {
  rates_.rays = rays_per_second;
  factors_[kMaps] = factors_[kRendering] = 1.0;
}

}  // namespace skyquilt::coordinator
