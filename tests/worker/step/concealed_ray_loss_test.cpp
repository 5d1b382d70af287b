#include "worker/step/concealed_ray_loss.h"

#include <gtest/gtest.h>

#include "core/brightness/brightness_options.h"
#include "core/brightness/luminance.h"
#include "core/brightness/tone_curve.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::worker {
namespace {

struct Compared {
  LossSums sums;
  ConcealedGradient gradient;
};

// An opaque ray of an over-exposed survey: its plain rendering is compared with the photo.
Compared Compare(bool toned, float rendered, float target) {
  BatchRay ray;
  ray.ray.target_srgb[0] = ray.ray.target_srgb[1] = ray.ray.target_srgb[2] = target;
  ConcealedRay composed;
  composed.plain = {{rendered, rendered, rendered}, 0.0F};
  ConcealedTask task;
  task.toned = toned;
  Compared compared;
  compared.gradient = LossOfConcealedRay(ray, {}, composed, task, 0.5F, compared.sums);
  return compared;
}

TEST(ConcealedRayLoss, PlainIsTheSquaredErrorOfDisplayValues) {
  const Compared plain = Compare(false, 0.95F, 0.90F);
  EXPECT_NEAR(plain.sums.loss, 3.0 * 0.05 * 0.05, 1e-7);
  for (const float gradient : plain.gradient.plain.rgb) EXPECT_NEAR(gradient, 2.0F * 0.05F * 0.5F, 1e-6F);
}

TEST(ConcealedRayLoss, TonedCountsBrightAndDarkDifferencesMore) {
  const float target = 0.90F, rendered = 0.95F;
  const Compared toned = Compare(true, rendered, target);
  const double residual = static_cast<double>(brightness::ToneCurve(rendered).value - brightness::ToneCurve(target).value);
  EXPECT_NEAR(toned.sums.loss, 3.0 * residual * residual, 1e-6);
  EXPECT_EQ(toned.sums.squared_error, Compare(false, rendered, target).sums.squared_error) << "PSNR is of display values in any case";
  // Against the middle of the range.
  const auto by_curve = [](float at) { return Compare(true, at + 0.02F, at).sums.loss / Compare(false, at + 0.02F, at).sums.loss; };
  EXPECT_GT(by_curve(0.02F), 2.0 * by_curve(0.5F));
  EXPECT_GT(by_curve(0.96F), 2.0 * by_curve(0.5F));
}

TEST(ConcealedRayLoss, WhichOneItIsStaysInTheFile) {
  const TemporaryFolder folder;
  for (const char* loss : {"toned", "plain"}) {
    brightness::BrightnessOptions options;
    options.correction = "luminance";
    options.luminance_loss = loss;
    const brightness::Luminance luminance = brightness::PlanLuminance(options, {.mean_srgb = 0.1, .clipped = 0.0});
    checkpoint::ArchiveWriter writer("context", 1);
    brightness::PutLuminance(luminance, {}, writer);
    writer.Commit(folder / "context.h5");
    brightness::Luminance back;
    brightness::LuminanceState state;
    brightness::GetLuminance(checkpoint::ArchiveReader(folder / "context.h5"), &back, &state);
    EXPECT_EQ(back.toned, std::string(loss) == "toned");
  }
}

}  // namespace
}  // namespace skyquilt::worker
