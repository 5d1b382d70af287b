#include "tests/evaluate/page/sample_report.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "evaluate/metrics/warnings.h"
#include "evaluate/page/report_images.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr double kExtent_m = 300.0;

// A town seen from above at (x, y) metres: meadows, streets, roofs.
void TownColor(double x, double y, double* rgb, double* height_m) {
  const double noise = 0.5 + 0.25 * std::sin(x * 0.9 + 2.0 * std::sin(y * 0.31)) + 0.25 * std::sin(y * 1.3 + std::sin(x * 0.7));
  const double street_x = std::abs(std::remainder(x, 50.0)), street_y = std::abs(std::remainder(y, 42.0));
  const double lot_x = std::floor(x / 25.0), lot_y = std::floor(y / 21.0);
  const double hash = std::abs(std::sin(lot_x * 12.9898 + lot_y * 78.233) * 43758.5453);
  const double pick = hash - std::floor(hash);
  const double in_x = x / 25.0 - lot_x, in_y = y / 21.0 - lot_y;
  *height_m = 0.0;
  if (street_x < 3.2 || street_y < 3.2) {
    const bool line = street_x < 0.25 || street_y < 0.25;
    for (int c = 0; c < 3; ++c) rgb[c] = line ? 0.85 : 0.42 + 0.04 * noise;
  } else if (pick > 0.35 && in_x > 0.3 && in_x < 0.75 && in_y > 0.3 && in_y < 0.8) {
    const double shade = in_y < 0.55 ? 1.0 : 0.78;
    const double roof[3] = {0.45 + 0.3 * pick, 0.3 + 0.12 * pick, 0.26};
    for (int c = 0; c < 3; ++c) rgb[c] = roof[c] * shade * (0.92 + 0.12 * noise);
    *height_m = 4.0 + 8.0 * pick;
  } else {
    rgb[0] = 0.30 + 0.12 * noise;
    rgb[1] = 0.42 + 0.12 * noise;
    rgb[2] = 0.22 + 0.08 * noise;
  }
}

image::Image8 TownPicture(int width, int height, double west, double north, double metres_per_pixel, double blur, image::ImageF* depth) {
  image::ImageF picture(width, height, 3);
  if (depth != nullptr) *depth = image::ImageF(width, height, 1);
  base::Random random(3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double rgb[3] = {0, 0, 0}, height_m = 0.0;
      const double jitter_x = blur * random.Normal(), jitter_y = blur * random.Normal();
      TownColor(west + (x + 0.5) * metres_per_pixel + jitter_x, north - (y + 0.5) * metres_per_pixel + jitter_y, rgb, &height_m);
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<float>(rgb[c]);
      if (depth != nullptr) *depth->At(x, y) = static_cast<float>(120.0 - height_m);
    }
  }
  return image::ToImage8(picture);
}

scene::FieldTraining TrainedField(const std::string& name, int block, double seconds, double final_psnr_db, base::Random& random,
                                  metrics::Curves* curves) {
  scene::FieldTraining field;
  field.block = block;
  field.name = name;
  field.ok = true;
  field.steps = static_cast<int64_t>(seconds * 14.0);
  field.seconds = seconds;
  field.rays = field.steps * 5200;
  field.samples = field.steps * 61000;
  field.parameters = name == "context" ? 1180672 : 4326400;
  field.psnr_db = final_psnr_db;
  field.phase_seconds = {{"hash forward", 0.4 * seconds}, {"network backward", 0.9 * seconds}, {"optimiser", 0.2 * seconds}};
  for (int i = 1; i <= 400; ++i) {
    const double t = seconds * i / 400.0;
    const double psnr_db = final_psnr_db - 14.0 * std::exp(-6.0 * t / seconds) - 2.0 * std::exp(-t / seconds) + 0.25 * random.Normal();
    (*curves)[name].push_back({t * 14.0, t, std::pow(10.0, -psnr_db / 10.0), psnr_db});
  }
  return field;
}

image::Image8 Brightened(image::Image8 picture, double stops) {
  for (uint8_t& value : picture.data) value = static_cast<uint8_t>(std::min(255.0, value * std::exp2(stops / 2.4)));
  return picture;
}

// Clouds during the flight: the tags contain part of the change, training learned the rest.
BrightnessReport CloudyFlight(const survey::Survey& survey, const std::filesystem::path& folder) {
  BrightnessReport report;
  report.timed = true;
  report.trust_in_tags = 0.87;
  report.spread_before_stops = 0.62;
  report.spread_after_stops = 0.21;
  for (const survey::Photo& photo : survey.photos) {
    BrightnessPhoto entry{photo.name, photo.flight, *photo.time_s, photo.is_test, 0.8 * std::sin(*photo.time_s / 45.0), {}};
    for (size_t c = 0; c < 3; ++c) entry.learned_stops[c] = 0.25 * std::cos(*photo.time_s / 20.0) + 0.06 * (static_cast<double>(c) - 1.0);
    report.photos.push_back(entry);
  }
  const auto bell = [](double middle, double width) {
    BrightnessHistogram shares = {};
    double total = 0.0;
    for (size_t bin = 0; bin < shares.size(); ++bin) {
      shares[bin] = std::exp(-std::pow((static_cast<double>(bin) / 64.0 - middle) / width, 2.0));
      total += shares[bin];
    }
    for (double& share : shares) share /= total;
    return shares;
  };
  report.histogram_before = bell(0.45, 0.28);
  report.histogram_after = bell(0.5, 0.2);
  VignettingCurve& vignetting = report.vignetting.emplace_back();
  for (size_t i = 0; i < vignetting.size(); ++i) vignetting[i] = std::exp(-0.004 * static_cast<double>(i * i));
  report.luminance = "Concealing field <none>.";
  for (const size_t i : {size_t{0}, size_t{24}}) {
    const double stops = i == 0 ? -0.71 : 1.23;
    const Eigen::Vector3d center = survey.photos[i].cam_from_enu.OriginInSource();
    const image::Image8 town = TownPicture(320, 210, center.x() - 74.0, center.y() + 48.0, 0.46, 0.0, nullptr);
    const image::Image8 taken = Brightened(town, stops);
    BrightnessView& view = report.views.emplace_back(WriteBrightnessView(taken, taken, town, folder, "brightness_" + std::to_string(i), 960));
    view.name = survey.photos[i].name;
    view.stops = stops;
  }
  return report;
}

constexpr double kLag_s = 0.3;
constexpr double kOffset_m[2] = {0.0, 3.5};
constexpr double kDrift_m[2] = {6.0, 2.5};

// How far the tag of a photo on the given line and step is off, apart from noise: behind on the track, and its height drifts.
Eigen::Vector3d TagError(int line, int along) {
  const int flight = line < 5 ? 0 : 1;
  const int n_lines = flight == 0 ? 5 : 4;
  const double progress = (9.0 * (line - 5 * flight) + along) / (9.0 * n_lines - 1.0);
  const double speed_mps = (line % 2 == 0 ? 1.0 : -1.0) * 32.5 / 4.0;
  return {-kLag_s * speed_mps, 0.0, kDrift_m[flight] * (progress - 0.5) - kOffset_m[flight]};
}

// What prepare says of a survey with these tags.
void FillGeoFit(survey::Survey* survey) {
  survey::GeoFit& fit = survey->fit;
  fit = {.n_matches = 80, .n_inliers = 78, .rmse_m = 2.41, .rmse_horizontal_m = 1.62, .rmse_vertical_m = 1.78, .scale = 41.7, .tag_lag_s = kLag_s};
  fit.tag_lag_sigma_s = 0.05;
  fit.flight_vertical_offset_m.assign(std::begin(kOffset_m), std::end(kOffset_m));
  fit.flight_vertical_drift_m.assign(std::begin(kDrift_m), std::end(kDrift_m));
  fit.accuracy = {.scale_percent = 0.21, .tilt_deg = 0.31, .yaw_deg = 0.17, .horizontal_m = 1.6, .vertical_m = 2.2};
  fit.gravity = {{.kind = "gimbal", .n = 81, .lean_east_deg = 0.12, .lean_north_deg = -0.08, .sigma_deg = 0.35, .weight = 0.78},
                 {.kind = "cameras", .n = 81, .lean_east_deg = -0.4, .lean_north_deg = 0.3, .sigma_deg = 0.9, .weight = 0.15},
                 {.kind = "ground", .n = 5213, .lean_east_deg = -0.2, .lean_north_deg = -1.3, .sigma_deg = 1.5, .weight = 0.07},
                 {.kind = "gps_heights", .n = 78, .lean_east_deg = 3.9, .lean_north_deg = 2.1, .sigma_deg = kNotMeasured, .weight = 0.0}};
  fit.tags_alone_tilt_deg = 4.4;
  survey->checks = {.speed_mps = 8.1,
                    .speed_source = "positions and times",
                    .readout_ms = 33.0,
                    .camera_name = "DJI <FC300S>",
                    .smear_px = 4.4,
                    .dome_m = 0.42,
                    .dome_sigma_m = 0.31,
                    .k1 = -0.0123,
                    .k1_sigma = 0.0004};
  survey->problems = {
      {"rolling_shutter", "The picture moves by 4.4 pixels while the sensor is read out", "Fly slower or higher, or use a mechanical shutter"},
      {"tags_disagree", "The GPS tags of 2 of 80 photos disagree with the rest & were not used", "Compare the residuals under Geo-reference", true}};
}

// Nine lines of nine photos over the town in two flights; the tags of two photos are far off, one has no height and one photo has none.
survey::Survey FlownSurvey(base::Random& random) {
  survey::Survey survey;
  survey.origin = {47.3769, 8.5417, 455.0};
  survey.georeferenced = true;
  camera::Camera camera;
  camera.width = 640;
  camera.height = 420;
  camera.params = {520.0, 520.0, 320.0, 210.0};
  survey.cameras = {camera};
  const geo::EnuFrame frame(survey.origin);
  int index = 0;
  for (int line = 0; line < 9; ++line) {
    for (int along = 0; along < 9; ++along, ++index) {
      survey::Photo photo;
      const int step = line % 2 == 0 ? along : 8 - along;
      const Eigen::Vector3d center(-130.0 + 32.5 * step, -130.0 + 32.5 * line, 120.0);
      photo.name = index == 24 ? "flight2/<b>DJI & \"co\"</b>.jpg" : "flight1/DJI_" + std::to_string(1000 + index) + ".JPG";
      photo.flight = line < 5 ? 0 : 1;
      photo.cam_from_enu.rotation = Eigen::Quaterniond(0, 1, 0, 0);
      photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * center);
      Eigen::Vector3d residual{1.4 * random.Normal(), 1.4 * random.Normal(), 2.0 * random.Normal()};
      if (index == 40) residual += Eigen::Vector3d(22.0, 5.0, 0.0);
      if (index == 60) residual += Eigen::Vector3d(-140.0, 400.0, 30.0);
      photo.gps_correction_m = -TagError(line, along);
      photo.gps = frame.GeodeticFromEnu(center - residual - photo.gps_correction_m);
      photo.gps_residual_m = residual.norm();
      if (index == 12) {
        photo.gps->height_m = kNotMeasured;
        photo.gps_residual_m = residual.head<2>().norm();
      }
      photo.time_s = 4.0 * index + (line < 5 ? 0.0 : 1500.0);
      photo.agl_m = 118.0 + random.Normal();
      photo.relative_altitude_m = 120.0;
      photo.gps_inlier = index != 40 && index != 60;
      photo.is_test = index % 8 == 0;
      survey.photos.push_back(photo);
    }
  }
  survey::Photo& untagged = survey.photos[77];
  untagged.gps.reset();
  untagged.gps_correction_m.setZero();
  untagged.gps_residual_m = kNotMeasured;
  untagged.gps_inlier = false;
  survey.unregistered = {"flight1/DJI_1082.JPG", "flight1/DJI_1083.JPG"};
  FillGeoFit(&survey);
  return survey;
}

// Two rows of three, the last of them empty.
partition::BlockSet TownBlocks(const survey::Survey& survey) {
  partition::BlockSet blocks;
  blocks.origin = survey.origin;
  blocks.georeferenced = true;
  blocks.rows = 2;
  blocks.columns = 3;
  blocks.image_width = 480;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      partition::Block block;
      block.id = row * 3 + column;
      block.name = "r" + std::to_string(row) + "c" + std::to_string(column);
      block.min_enu = {-150.0 + 100.0 * column, -150.0 + 150.0 * row, -2.1};
      block.max_enu = block.min_enu + Eigen::Vector3d(100.0, 150.0, 16.0 + 3.0 * column);
      block.margin_m = 10.0;
      block.altitude_agl_m = 118.0;
      block.gsd_m = 0.061;
      block.photos.resize(30 + 7 * static_cast<size_t>(column));
      if (row == 1 && column == 2) {
        block.empty = true;
        block.empty_reason = "no sparse point and no photo inside";
      }
      blocks.blocks.push_back(block);
    }
  }
  return blocks;
}

scene::TrainReport TrainedBlocks(const partition::BlockSet& blocks, base::Random& random, metrics::Curves* curves) {
  scene::TrainReport training;
  training.ranks = 2;
  training.threads = 4;
  training.wall_seconds = 611.0;
  training.fields.push_back(TrainedField("context", -1, 90.0, 24.8, random, curves));
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    training.fields.push_back(TrainedField(block.name, block.id, 190.0 + 12.0 * block.id, 27.6 + 0.5 * block.id, random, curves));
  }
  training.fields[0].peak_rss_bytes = int64_t{2640} << 20;
  training.fields[3].dropped_steps = 2;
  return training;
}

photos::PhotoScore ScoreOf(const survey::Survey& survey, int index, base::Random& random) {
  photos::PhotoScore score;
  score.photo = index;
  score.name = survey.photos[static_cast<size_t>(index)].name;
  score.width = 640;
  score.height = 420;
  score.used_pixels = 640 * 420;
  score.covered_pixels = static_cast<int64_t>(640 * 420 * (0.86 + 0.1 * random.UniformDouble()));
  score.exposure_gain = random.Uniform(0.8, 1.2);
  score.psnr_db = 28.0 + random.Normal();
  score.ssim = 0.86 + 0.02 * random.Normal();
  score.psnr_full_db = score.psnr_db - 1.3;
  score.ssim_full = score.ssim - 0.03;
  score.flip = 0.11 + 0.01 * random.Normal();
  score.flip_full = score.flip + 0.01;
  score.depth_rmse_m = 1.1 + 0.1 * random.Normal();
  score.depth_median_abs_m = 0.21 + 0.03 * random.Normal();
  score.render_seconds = 1.7 + 0.1 * random.Normal();
  return score;
}

PhotoImages PicturesOf(const survey::Photo& photo, const std::filesystem::path& folder, const std::string& prefix) {
  const Eigen::Vector3d center = photo.cam_from_enu.OriginInSource();
  const double metres_per_pixel = 120.0 / 520.0;
  image::ImageF depth;
  const image::Image8 taken =
      TownPicture(640, 420, center.x() - 320 * metres_per_pixel, center.y() + 210 * metres_per_pixel, metres_per_pixel, 0.0, nullptr);
  const image::Image8 render =
      TownPicture(640, 420, center.x() - 320 * metres_per_pixel, center.y() + 210 * metres_per_pixel, metres_per_pixel, 0.3, &depth);
  std::vector<uint8_t> scored(640 * 420, 1);
  for (size_t p = 0; p < scored.size(); ++p) scored[p] = p % 640 < 580 ? 1 : 0;
  return WritePhotoImages({&taken, &render, &depth, scored}, folder, prefix, 960, 0.25F);
}

// Everything but the scores of photos and blocks.
void FillSceneMetrics(const survey::Survey& survey, const partition::BlockSet& blocks, const scene::TrainReport& training,
                      metrics::Metrics& metrics) {
  std::vector<double> psnr, ssim, flip;
  for (const photos::PhotoScore& photo : metrics.photos) {
    psnr.push_back(photo.psnr_db);
    ssim.push_back(photo.ssim);
    flip.push_back(photo.flip);
  }
  metrics.psnr = MeanOfMeasured(psnr);
  metrics.ssim = MeanOfMeasured(ssim);
  metrics.flip = MeanOfMeasured(flip);
  metrics.psnr_exif_gain = metrics.psnr - 0.9;
  metrics.psnr_1000 = metrics.psnr + 0.4;
  metrics.psnr_right_half = metrics.psnr - 0.1;
  metrics.psnr_right_half_fitted = metrics.psnr + 0.3;
  metrics.psnr_full_frame = metrics.psnr - 1.3;
  metrics.ssim_full_frame = metrics.ssim - 0.03;
  metrics.flip_full_frame = metrics.flip + 0.01;
  metrics.coverage = 0.912;
  metrics.lpips_note = "not measured: evaluate.lpips_network is not set";
  metrics.psnr_interior_db = 28.4;
  metrics.psnr_matched_interior_db = 28.4;
  metrics.psnr_seam_db = 28.28;
  metrics.seam_psnr_gap_db = 0.12;
  metrics.depth_rmse_m = 1.12;
  metrics.depth_median_abs_m = 0.21;
  metrics.floater_opacity = 0.0184;
  metrics.kept_points = {.points = 4100, .rays = 16210, .median_m = 0.012, .median_abs_m = 0.081, .nmad_m = 0.115};
  metrics.kept_points.median_gsd = 0.2;
  metrics.kept_points.median_abs_gsd = 1.34;
  metrics.kept_points.nmad_gsd = 1.91;
  metrics.kept_points.share_beyond_10_gsd = 0.031;
  metrics.exposure_seam = 0.0031;
  metrics.exposure_seam_control = 0.0027;
  metrics.train_seconds = training.TrainSeconds();
  metrics.samples_per_second = training.SamplesPerSecond();
  metrics.peak_rss_bytes = training.PeakRssBytes();
  metrics.evaluate_peak_rss_bytes = int64_t{830} << 20;
  metrics.evaluate_seconds = 24.0;
  metrics.parameters = 22812672;
  metrics.ranks = training.ranks;
  metrics.threads = training.threads;
  metrics.config = "[train]\n# resolutions of the hash grid\nlevels = 8\nfeatures = 4\n\n[partition]\nblocks = \"2x3\"\n";
  metrics.georeferenced = true;
  metrics.geo_fit = survey.fit;
  for (const survey::Problem& problem : survey.problems) metrics.problem_codes.push_back(problem.code);
  metrics.median_agl_m = survey.MedianAgl();
  metrics.median_relative_altitude_m = 120.0;
  metrics.gsd_m = 0.061;
  metrics.n_photos = static_cast<int>(survey.photos.size());
  metrics.n_unregistered = static_cast<int>(survey.unregistered.size());
  metrics.n_test = static_cast<int>(metrics.photos.size());
  metrics.image_width = 640;
  metrics.machine = "8-core laptop, 16 GiB, Linux";
  metrics.date = "2026-01-31T12:00:00Z";
  metrics.warnings = metrics::CollectWarnings(survey, blocks, &training, metrics);
}

}  // namespace

SampleReport::SampleReport(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "images");
  base::Random random(11);
  survey = FlownSurvey(random);
  blocks = TownBlocks(survey);
  training = TrainedBlocks(blocks, random, &curves);
  metrics.has_truth = true;
  for (const partition::Block& block : blocks.blocks) {
    if (!block.empty) metrics.blocks.push_back({block.name, 26.8 + 0.45 * block.id, 241000 + 9000 * block.id});
  }
  for (size_t i = 0; i < survey.photos.size(); i += 8) {
    metrics.photos.push_back(ScoreOf(survey, static_cast<int>(i), random));
    input.images.push_back(PicturesOf(survey.photos[i], folder, "t" + std::to_string(i)));
  }
  image::SavePng(TownPicture(900, 900, -kExtent_m / 2, kExtent_m / 2, kExtent_m / 900.0, 0.0, nullptr), folder / "images/orthophoto.png");
  input.background = MapBackground{"images/orthophoto.png", {-kExtent_m / 2, -kExtent_m / 2}, {kExtent_m / 2, kExtent_m / 2}};
  input.color_ramp = WriteColorRamp(folder);
  FillSceneMetrics(survey, blocks, training, metrics);

  brightness = CloudyFlight(survey, folder);
  input.title = "town <sample>";
  input.curves = curves;
  input.brightness = &brightness;
}

void SampleReport::MakePoor() {
  survey.georeferenced = metrics.georeferenced = false;
  const std::vector<survey::GravityEvidence> gravity = survey.fit.gravity;
  survey.fit = {};
  survey.fit.gravity = {gravity[1], gravity[2]};
  metrics.geo_fit = survey.fit;
  survey.checks = {.k1 = -0.0123, .k1_sigma = 0.0004};
  survey.problems = {
      {"no_georeference", "None of the photos <at all> has GPS tags", "Use photos with GPS tags and run the same command with --restart", true}};
  metrics.problem_codes = {"no_georeference"};
  for (survey::Photo& photo : survey.photos) {
    photo.gps.reset();
    photo.gps_correction_m.setZero();
    photo.gps_residual_m = kNotMeasured;
    photo.gps_inlier = false;
  }
  for (int i = 0; i < 200; ++i) survey.unregistered.push_back("flight1/DJI_" + std::to_string(2000 + i) + ".JPG");
  metrics.n_unregistered = static_cast<int>(survey.unregistered.size());
  metrics.has_truth = false;
  metrics.coverage = 0.31;
  metrics.seam_psnr_gap_db = kNotMeasured;
  metrics.n_test = 3 * static_cast<int>(metrics.photos.size());
  blocks.georeferenced = false;
  blocks.blocks[0].empty = true;
  blocks.blocks[0].empty_reason = "only one training photo sees it";
  training.fields[2].ok = false;
  training.fields[2].reason = "loss or gradient was not finite in 20 steps in a row";
  training.fields.pop_back();
  metrics.warnings = metrics::CollectWarnings(survey, blocks, &training, metrics);
}

}  // namespace skyquilt::evaluate::page
