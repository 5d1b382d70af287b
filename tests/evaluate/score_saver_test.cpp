#include "evaluate/score_saver.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <fstream>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/random.h"
#include "tests/evaluate/photos/nadir_view.h"
#include "tests/support/not_finite.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate {
namespace {

constexpr int kSavedWidth = 10, kSavedHeight = 8;
constexpr size_t kSavedBoxes = 3;

struct RandomPhoto {
  photos::ScoredPhoto photo;
  surface::SurfacePicture mesh;

  // truth: as in a simulated survey.
  RandomPhoto(int number, bool truth, base::Random& random) {
    const auto some = [&random](double value, double otherwise) { return random.Uniform(0.0, 1.0) < 0.1 ? otherwise : value; };
    const auto any = [&](double from, double to) {
      const double value = random.Uniform(from, to);
      const double otherwise = random.Uniform(0.0, 1.0) < 0.5 ? kNan : kInfinity;
      return some(value, otherwise);
    };
    const photos::TrainingView view = photos::NadirView(0, 0, 100);
    photo.task.camera = view.camera.Resized(kSavedWidth, kSavedHeight);
    photo.task.cam_from_enu = view.cam_from_enu;
    photo.task.photo = image::Image8(kSavedWidth, kSavedHeight, 3);
    photos::PhotoResult& findings = photo.findings;
    findings.scored = image::Image8(kSavedWidth, kSavedHeight, 1, 1);
    findings.render = image::Image8(kSavedWidth, kSavedHeight, 3);
    findings.z_depth = image::ImageF(kSavedWidth, kSavedHeight, 1);
    mesh.colors.resize(findings.scored.data.size());
    mesh.has_mesh.resize(findings.scored.data.size());
    for (uint8_t& value : photo.task.photo.data) value = static_cast<uint8_t>(random.Uniform(0.0, 255.0));
    for (uint8_t& value : findings.render.data) value = static_cast<uint8_t>(random.Uniform(0.0, 255.0));
    for (uint8_t& flag : findings.scored.data) flag = static_cast<uint8_t>(some(1.0, 0.0));
    for (float& depth : findings.z_depth.data) depth = static_cast<float>(any(99.0, 101.0));
    for (uint8_t& flag : mesh.has_mesh) flag = static_cast<uint8_t>(some(1.0, 0.0));
    for (render::RayColor& color : mesh.colors) color.rgb_srgb[1] = static_cast<float>(random.Uniform(0.0, 1.0));
    findings.per_block.resize(kSavedBoxes);
    for (skyquilt::metrics::SquaredError& error : findings.per_block) error = {random.Uniform(0.0, 9.0), 30};
    for (skyquilt::metrics::SquaredError& error : findings.seams.interior) error = {random.Uniform(0.0, 9.0), 30};
    for (skyquilt::metrics::SquaredError& error : findings.seams.seam) error = {random.Uniform(0.0, 9.0), 3};
    photos::PhotoScore& score = findings.score;
    score.photo = 3 * number;
    score.name = "photos/" + std::to_string(number) + ".jpg";
    score.width = kSavedWidth;
    score.height = kSavedHeight;
    score.used_pixels = 80;
    score.covered_pixels = 70 + number;
    for (double photos::PhotoScore::*value :
         {&photos::PhotoScore::exposure_gain, &photos::PhotoScore::psnr_db, &photos::PhotoScore::psnr_exif_gain_db,
          &photos::PhotoScore::psnr_normal_db, &photos::PhotoScore::ssim_normal, &photos::PhotoScore::ssim, &photos::PhotoScore::flip,
          &photos::PhotoScore::psnr_full_db, &photos::PhotoScore::ssim_full, &photos::PhotoScore::flip_full, &photos::PhotoScore::lpips,
          &photos::PhotoScore::right_half_db, &photos::PhotoScore::right_half_fitted_db, &photos::PhotoScore::depth_rmse_m,
          &photos::PhotoScore::depth_median_abs_m, &photos::PhotoScore::render_seconds}) {
      score.*value = any(0.0, 40.0);
    }
    for (double& stops : score.predicted_stops) stops = any(-1.0, 1.0);
    for (double& stops : score.fitted_stops) stops = any(-1.0, 1.0);
    if (truth) AddTruth(any, random);
  }

 private:
  template <typename Any>
  void AddTruth(const Any& any, base::Random& random) {
    photos::PhotoResult& findings = photo.findings;
    findings.true_depth = image::ImageF(kSavedWidth, kSavedHeight, 1, 100.0F);
    findings.true_class = image::Image8(kSavedWidth, kSavedHeight, 1, static_cast<uint8_t>(survey::SurfaceClass::kRoof));
    findings.true_normals = image::ImageF(kSavedWidth, kSavedHeight, 3, 0.0F);
    for (size_t i = 0; i < findings.true_class.data.size(); ++i) {
      findings.true_normals.data[3 * i + 2] = 1.0F;
      if (random.Uniform(0.0, 1.0) < 0.4) findings.true_class.data[i] = static_cast<uint8_t>(random.Uniform(0.0, 9.99));
      if (random.Uniform(0.0, 1.0) < 0.1) findings.true_depth.data[i] = static_cast<float>(any(99.0, 101.0));
    }
    const auto normals = [&] {
      image::ImageF field(kSavedWidth, kSavedHeight, 3);
      for (float& value : field.data) value = static_cast<float>(any(-1.0, 1.0));
      return field;
    };
    findings.normals = normals();
    if (random.Uniform(0.0, 1.0) < 0.5) findings.density_normals = normals();
    if (random.Uniform(0.0, 1.0) < 0.5) findings.head_normals = normals();
    for (double& sum : photo.floaters.sum) sum = random.Uniform(0.0, 5.0);
    photo.floaters.rays.fill(5);
  }
};

// What an evaluation accumulates.
struct Accumulated {
  metrics::Scores scores{kSavedBoxes};
  surface::SurfacePhotoErrors surface;
  page::WrittenPictures pictures;

  Accumulated() {
    scores.flat_roofs = photos::FlatRoofPoints({{{-30, 0}, {1, 0}, {30, 50}}, {{30, 0}, {0, 1}, {50, 30}}});
    pictures.views.resize(2);
  }
  void Add(const RandomPhoto& one) {
    surface.Add(one.photo.task, one.photo.findings, one.mesh);
    scores.Add(one.photo);
    page::PhotoImages images;
    const photos::PhotoScore& score = one.photo.findings.score;
    if (score.photo % 2 == 0) {
      images.photo = "images/photo_" + std::to_string(score.photo) + ".jpg";
      images.width = kSavedWidth;
      images.depth_low_m = score.psnr_db;
      pictures.views[pictures.images.size() % 2] = {
          .name = score.name, .stops = score.psnr_db, .photo = "images/view.jpg", .recorded = "", .normal = "", .width = 10, .height = 8};
      ++pictures.n_with_normals;
    }
    pictures.images.push_back(images);
  }
  ScoreState State() { return {.scores = &scores, .surface = &surface, .pictures = &pictures}; }

  std::string Saved() const {
    base::BytePacker out;
    scores.Save(&out);
    surface.Save(&out);
    pictures.Save(&out);
    return out.Take();
  }
  void Load(const std::string& saved) {
    base::ByteUnpacker in(saved, "damaged");
    scores.Load(&in);
    surface.Load(&in);
    pictures.Load(&in);
    in.End();
  }
  // The bits of everything that a report is made of.
  std::string Results() const {
    base::BytePacker out;
    out.Add(scores.Psnr());
    out.Add(scores.Coverage());
    for (const photos::PhotoScore& photo : scores.photos) {
      out.Add(photo.name);
      out.Add(std::array{photo.psnr_db, photo.lpips, photo.fitted_stops[2], photo.depth_median_abs_m, photo.render_seconds});
      out.Add(std::array{photo.used_pixels, photo.covered_pixels, int64_t{photo.photo}, int64_t{photo.width}});
    }
    out.Add(scores.per_block);
    out.Add(scores.seams.GapDb());
    out.Add(scores.depth.Result());
    for (const metrics::ClassScore& one : scores.classes.Result()) {
      out.Add(one.name);
      out.Add(std::array{one.pixels, one.missing_pixels});
      out.Add(std::array{one.depth_bias_m, one.depth_median_abs_m, one.depth_nmad_m, one.depth_rmse_m, one.normal_median_deg, one.normal_mean_deg,
                         one.density_normal_median_deg, one.head_normal_median_deg});
    }
    const photos::FlatRoofScore roofs = scores.flat_roofs.Result();
    out.Add(roofs.roofs);
    out.Add(std::array{roofs.spread.rms_m, roofs.spread.nmad_m});
    for (const auto& [clearance_m, opacity] : scores.floaters.Profile()) out.Add(opacity);
    surface::SurfaceScores mesh;
    surface.Fill(&mesh);
    out.Add(std::array{mesh.psnr, mesh.psnr_field, mesh.psnr_where_mesh, mesh.psnr_field_where_mesh, mesh.missing_share});
    for (const surface::SurfaceClassScore& one : mesh.classes) out.Add(std::array{one.psnr_db, one.psnr_field_db});
    for (const page::PhotoImages& images : pictures.images) out.Add(images.photo);
    for (const page::BrightnessView& view : pictures.views) out.Add(view.name);
    return out.Take();
  }
};

RC_GTEST_PROP(SavedScores, GoOnAsIfNeverInterrupted, ()) {
  const auto seed = *rc::gen::arbitrary<uint32_t>();
  const auto n = *rc::gen::inRange(0, 5);
  const auto n_before = *rc::gen::inRange(0, n + 1);
  const bool truth = *rc::gen::arbitrary<bool>();
  base::Random random(seed);
  std::vector<RandomPhoto> photos;
  for (int i = 0; i < n; ++i) photos.emplace_back(i, truth, random);
  Accumulated whole, first, second;
  for (const RandomPhoto& photo : photos) whole.Add(photo);
  for (int i = 0; i < n_before; ++i) first.Add(photos[static_cast<size_t>(i)]);
  second.Load(first.Saved());
  RC_ASSERT(second.Saved() == first.Saved());
  RC_ASSERT(second.Results() == first.Results());
  for (int i = n_before; i < n; ++i) second.Add(photos[static_cast<size_t>(i)]);
  RC_ASSERT(second.Saved() == whole.Saved());
  RC_ASSERT(second.Results() == whole.Results());
}

// The test above would pass if the photos had nothing to measure.
TEST(SavedScores, OfThePhotosOfTheseTestsAreMeasured) {
  base::Random random(1);
  Accumulated all;
  for (int i = 0; i < 4; ++i) all.Add({i, true, random});
  EXPECT_EQ(all.scores.flat_roofs.Result().roofs, 2);
  EXPECT_GT(all.scores.depth.Result().n, 100);
  ASSERT_EQ(all.scores.classes.Result().size(), 5U);
  EXPECT_GT(all.scores.classes.Result()[0].pixels, 50);
  surface::SurfaceScores mesh;
  all.surface.Fill(&mesh);
  EXPECT_EQ(mesh.classes.size(), surface::ScoredClasses().size());
}

TEST(SavedScores, OfOtherBoxesRoofsOrViewsAreRefused) {
  const std::string saved = Accumulated().Saved();
  Accumulated boxes, roofs, views;
  EXPECT_NO_THROW(Accumulated().Load(saved));
  boxes.scores.per_block.resize(kSavedBoxes + 1);
  EXPECT_THROW(boxes.Load(saved), base::UnreadableBytes);
  roofs.scores.flat_roofs = photos::FlatRoofPoints(std::vector<photos::RoofArea>(1));
  EXPECT_THROW(roofs.Load(saved), base::UnreadableBytes);
  views.pictures.views.clear();
  EXPECT_THROW(views.Load(saved), base::UnreadableBytes);
}

class SavedEvaluation : public ::testing::Test {
 protected:
  SavedEvaluation() {
    base::SetLogLevel(base::LogLevel::kError);
    input_.project_folder = folder_.path();
    input_.progress_file = folder_ / "progress.bin";
    input_.progress_key = "options and inputs";
    base::RequireWritableFolder(input_.ReportFolder() / "images");
    base::Random random(7);
    for (int i = 0; i < 2; ++i) {
      before_.Add({i, true, random});
      for (const page::PhotoImages& images : before_.pictures.images) Touch(images.photo);
    }
    Touch("images/view.jpg");
    ScoreSaver(input_, held_out_, before_.State()).Save();
  }
  ~SavedEvaluation() override { base::InitLog(false); }

  void Touch(const std::string& picture) const {
    if (!picture.empty()) std::ofstream(input_.ReportFolder() / picture) << "picture";
  }
  // How many photos an evaluation begins with. Those that it does not use are forgotten.
  size_t PhotosOf(const EvaluateInput& input, const std::vector<int>& held_out, bool surface = true) const {
    Accumulated after;
    ScoreState state = after.State();
    if (!surface) state.surface = nullptr;
    ScoreSaver saver(input, held_out, state);
    saver.Resume();
    const size_t n = after.scores.photos.size();
    EXPECT_EQ(after.Saved(), n > 0 ? before_.Saved() : Accumulated().Saved());
    EXPECT_EQ(saver.earlier_s() > 0.0, n > 0);
    EXPECT_EQ(std::filesystem::exists(input.progress_file), n > 0);
    return n;
  }

  TemporaryFolder folder_;
  EvaluateInput input_;
  const std::vector<int> held_out_ = {0, 3, 6};
  Accumulated before_;
};

TEST_F(SavedEvaluation, IsContinuedAndSaysSo) {
  ::testing::internal::CaptureStderr();
  base::InitLog(false);
  const size_t n = PhotosOf(input_, held_out_);
  const std::string log = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(n, 2U);
  EXPECT_NE(log.find("evaluate: continues after 2 of 3 photos"), std::string::npos) << log;
  EXPECT_EQ(PhotosOf(input_, held_out_), 2U);  // killed again before anything was saved
}

TEST_F(SavedEvaluation, OfOtherInputsBeginsAnew) {
  EvaluateInput other = input_;
  other.progress_key = "other options or inputs";
  EXPECT_EQ(PhotosOf(other, held_out_), 0U);
  EXPECT_EQ(PhotosOf(input_, held_out_), 0U);  // its pictures may have been replaced since
}

TEST_F(SavedEvaluation, OfOtherPhotosBeginsAnew) {
  EXPECT_EQ(PhotosOf(input_, {0, 3}), 0U);
}

TEST_F(SavedEvaluation, WithoutItsSurfaceBeginsAnew) {
  EXPECT_EQ(PhotosOf(input_, held_out_, false), 0U);
}

TEST_F(SavedEvaluation, WithoutItsPicturesBeginsAnew) {
  std::filesystem::remove(input_.ReportFolder() / before_.pictures.images.front().photo);
  EXPECT_EQ(PhotosOf(input_, held_out_), 0U);
}

TEST_F(SavedEvaluation, WithoutItsViewsBeginsAnew) {
  std::filesystem::remove(input_.ReportFolder() / "images" / "view.jpg");
  EXPECT_EQ(PhotosOf(input_, held_out_), 0U);
}

TEST_F(SavedEvaluation, WithoutItsScoredPixelsBeginsAnew) {
  input_.options.scored_pixels_folder = folder_ / "pixels";
  std::filesystem::create_directories(folder_ / "pixels" / "photos");
  for (const photos::PhotoScore& photo : before_.scores.photos) std::ofstream(folder_ / "pixels" / (photo.name + ".png")) << "picture";
  ScoreSaver(input_, held_out_, before_.State()).Save();
  EXPECT_EQ(PhotosOf(input_, held_out_), 2U);
  std::filesystem::remove_all(folder_ / "pixels");
  EXPECT_EQ(PhotosOf(input_, held_out_), 0U);
}

TEST_F(SavedEvaluation, CountsTheTimeOfAllItsParts) {
  Accumulated after;
  ScoreSaver saver(input_, held_out_, after.State());
  saver.Resume();
  saver.Save();
  Accumulated last;
  ScoreSaver third(input_, held_out_, last.State());
  third.Resume();
  EXPECT_GT(third.earlier_s(), saver.earlier_s());
}

TEST_F(SavedEvaluation, ThatCannotBeSavedGoesOn) {
  input_.progress_file = folder_ / "no such folder" / "progress.bin";
  ScoreSaver saver(input_, held_out_, before_.State());
  EXPECT_NO_THROW(saver.Save());
  input_.progress_file.clear();
  ScoreSaver unsaved(input_, held_out_, before_.State());
  EXPECT_NO_THROW(unsaved.Resume());
  EXPECT_NO_THROW(unsaved.Save());
  EXPECT_NO_THROW(unsaved.Remove());
}

TEST(SaveSchedule, SavingTakesATwentiethOfTheTimeAtMost) {
  SaveSchedule schedule(20.0, 100.0);
  EXPECT_FALSE(schedule.Due(119.0));
  EXPECT_TRUE(schedule.Due(120.0));
  schedule.Saved(120.0, 120.5);
  EXPECT_FALSE(schedule.Due(140.0));
  EXPECT_TRUE(schedule.Due(140.5));
  schedule.Saved(140.5, 150.5);
  EXPECT_FALSE(schedule.Due(350.0));
  EXPECT_TRUE(schedule.Due(350.6));
}

}  // namespace
}  // namespace skyquilt::evaluate
