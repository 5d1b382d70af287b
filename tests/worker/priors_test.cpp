// Trains blocks of the small survey with priors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/render/ray_engine.h"
#include "core/scene/field_file.h"
#include "tests/worker/small_survey.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

class PriorsTest : public SmallSurvey {
 protected:
  // Sparse points on the ground and on the box, lifted by `lift_m`, with the photos that show them.
  void AddPoints(double lift_m) {
    for (double y = -8.0; y <= 8.0; y += 1.0) {
      for (double x = -8.0; x <= 8.0; x += 1.0) {
        const bool on_box = std::abs(x) <= 3.0 && std::abs(y) <= 3.0;
        const Vector3d point(x, y, (on_box ? 4.0 : 0.0) + lift_m);
        std::vector<int32_t> photos;
        for (size_t i = 0; i < survey_.photos.size(); ++i) {
          const std::optional<Eigen::Vector2d> pixel = survey_.cameras[0].ImgFromCam(survey_.photos[i].cam_from_enu * point);
          if (pixel && (pixel->array() > 0.0).all() && pixel->x() < kSmallWidth && pixel->y() < kSmallHeight)
            photos.push_back(static_cast<int32_t>(i));
        }
        survey_.points.push_back({point, {}, 0.5F, static_cast<int>(photos.size())});
        survey_.tracks.Add(std::move(photos));
      }
    }
  }
  TrainJob JobWith(const std::string& name, int steps, const PriorOptions& priors) const {
    TrainJob job = Job(name, steps);
    job.priors = priors;
    return job;
  }
  // Trains free.h5 without priors and held.h5 with these, which grow from early on, planes to their full size at once.
  void TrainFreeAndHeld(double lift_m, PriorOptions priors, base::ThreadPool& threads, int steps = 600) {
    AddPoints(lift_m);
    priors.from = 0.1;
    priors.until = priors.points > 0.0 ? 0.9 : 0.2;  // points begin to fade then
    priors.points_end = 1.0;
    TrainContext(Job("context.h5", 2 * steps / 5), Box(20.0, 0.0), threads, {});
    TrainBlock(Job("free.h5", steps), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
    TrainBlock(JobWith("held.h5", steps, priors), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  }
  // Rays straight down from 30 m onto the ground beside the box.
  std::vector<render::RayColor> LookDown(const std::string& checkpoint, base::ThreadPool& threads) const {
    const checkpoint::ArchiveReader reader(folder_ / checkpoint);
    const render::TrainedField field = scene::GetField(reader, folder_ / checkpoint, "");
    render::FieldSet set;
    set.blocks = {&field};
    std::vector<render::Ray> rays;
    for (double x = -7.0; x <= 7.0; x += 0.5) rays.push_back({{x, 6.0, 30.0}, {0, 0, -1}});
    std::vector<render::RayColor> out(rays.size());
    render::RenderRays(set, rays, out, {.normals = true}, threads);
    return out;
  }
  // How many of these rays end within `reach` of a distance.
  std::ptrdiff_t EndAt(const std::string& checkpoint, float distance, float reach, base::ThreadPool& threads) const {
    const std::vector<render::RayColor> rays = LookDown(checkpoint, threads);
    return std::count_if(rays.begin(), rays.end(), [=](const render::RayColor& r) { return std::abs(r.depth_median - distance) < reach; });
  }
};

PriorOptions AllPriors() {
  PriorOptions priors;
  priors.planar = priors.upright = priors.planes = priors.points = priors.free_space = priors.normals = priors.orientation = 1e-2;
  priors.from = 0.1;
  priors.until = 0.3;
  return priors;
}

TEST_F(PriorsTest, BitsDoNotDependOnThreadsNorOnInterruption) {
  AddPoints(0.0);
  base::ThreadPool one(1), three(3);
  TrainContext(Job("context.h5", 60), Box(20.0, 0.0), one, {});
  const auto train = [&](const TrainJob& job, base::ThreadPool& threads) { TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", threads, {}); };
  train(JobWith("a.h5", 90, AllPriors()), one);
  train(JobWith("b.h5", 90, AllPriors()), three);
  EXPECT_EQ(Bytes("a.h5"), Bytes("b.h5"));
  TrainInterrupted(JobWith("c.h5", 90, AllPriors()), [&](const TrainJob& job) { train(job, one); });
  EXPECT_EQ(Bytes("a.h5"), Bytes("c.h5"));
}

TEST_F(PriorsTest, WithoutWeightsNothingChanges) {
  AddPoints(0.0);
  base::ThreadPool threads(1);
  TrainContext(Job("context.h5", 60), Box(20.0, 0.0), threads, {});
  PriorOptions off = PriorOptions::Off();
  off.from = off.until = 0.0;
  off.segment_share = off.point_share = 0.5;
  const auto train = [&](const TrainJob& job) { TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", threads, {}); };
  train(Job("a.h5", 60));
  train(JobWith("b.h5", 60, off));
  EXPECT_EQ(Bytes("a.h5"), Bytes("b.h5"));
  // Before their time they change nothing either, later they do.
  PriorOptions late = AllPriors();
  late.from = late.until = 1.0;
  late.normals = 0.0;  // otherwise the field has a head
  train(JobWith("c.h5", 60, late));
  EXPECT_EQ(Bytes("a.h5"), Bytes("c.h5"));
  // Each alone does something; planes of points, which need surfaces that are nearly opaque, only later (PlanesOfPointsMoveTheSurface).
  int run = 0;
  const std::vector<double PriorOptions::*> weights = {&PriorOptions::planar,     &PriorOptions::upright, &PriorOptions::points,
                                                       &PriorOptions::free_space, &PriorOptions::normals, &PriorOptions::orientation};
  for (const auto weight : weights) {
    PriorOptions one = AllPriors();
    one.planes = 0.0;
    for (const auto other : weights) one.*other = other == weight ? 1.0 : 0.0;
    const std::string name = "one" + std::to_string(run++) + ".h5";
    train(JobWith(name, 60, one));
    EXPECT_NE(Bytes("a.h5"), Bytes(name)) << name;
  }
}

// Points that lie are believed when their weight is large: the surface comes to them.
TEST_F(PriorsTest, PointsMoveTheSurface) {
  PriorOptions strong = PriorOptions::Off();
  strong.points = 1.0;
  strong.point_share = 0.3;
  base::ThreadPool threads(2);
  TrainFreeAndHeld(1.0, strong, threads);
  EXPECT_GT(EndAt("free.h5", 30.0F, 0.5F, threads), EndAt("free.h5", 29.0F, 0.5F, threads));
  EXPECT_GT(EndAt("held.h5", 29.0F, 0.5F, threads), 21);  // of 29
}

TEST_F(PriorsTest, PlanesOfPointsMoveTheSurface) {
  PriorOptions strong = PriorOptions::Off();
  strong.planes = 1.0;
  base::ThreadPool threads(2);
  TrainFreeAndHeld(0.4, strong, threads);
  EXPECT_GT(EndAt("free.h5", 30.0F, 0.2F, threads), EndAt("free.h5", 29.6F, 0.2F, threads));
  EXPECT_GT(EndAt("held.h5", 29.6F, 0.2F, threads), 21);
}

// Angle between the up direction and the mean normal, degrees; 90 without one.
double Tilt_deg(const float (&normal)[3]) {
  return std::acos(std::clamp(static_cast<double>(normal[2]), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

TEST_F(PriorsTest, NormalsOfDensityAndHeadAgreeWithTheSurface) {
  PriorOptions priors = PriorOptions::Off();
  priors.normals = 0.1;
  priors.segment_share = 0.3;
  base::ThreadPool threads(2);
  TrainFreeAndHeld(0.0, priors, threads, 1000);
  double free = 0.0, held = 0.0, head = 0.0;
  for (const render::RayColor& ray : LookDown("free.h5", threads)) free += Tilt_deg(ray.density_normal) / 29.0;
  for (const render::RayColor& ray : LookDown("held.h5", threads)) {
    held += Tilt_deg(ray.density_normal) / 29.0;
    head += Tilt_deg(ray.predicted_normal) / 29.0;
  }
  EXPECT_LT(held, 0.9 * free);
  EXPECT_LT(head, 15.0);
}

}  // namespace
}  // namespace skyquilt::worker
