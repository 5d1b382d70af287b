#include "prepare/bundle/bundle_costs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "prepare/bundle/entry_term.h"
#include "prepare/poses/seed/seed_rotation.h"

namespace skyquilt::test {
namespace {

using namespace prepare::bundle;

PoseNumbers RandomPose(base::Random& random) {
  const double yaw = random.Uniform(0.0, 360.0), pitch = random.Uniform(-90.0, -40.0);
  const Eigen::Quaterniond rotation = prepare::poses::RotationFromAngles(yaw, pitch, random.Uniform(-10.0, 10.0));
  PoseNumbers pose{};
  Eigen::Map<Eigen::Vector4d>(pose.data()) = rotation.coeffs();
  for (size_t k = 4; k < 7; ++k) pose[k] = random.Uniform(-20.0, 20.0);
  pose[6] += 80.0;
  return pose;
}

// Compares all derivatives with central differences; blocks of seven numbers change by PoseManifold.
void ExpectDerivatives(const ceres::CostFunction& cost, std::vector<std::vector<double>> blocks) {
  const PoseManifold manifold;
  const auto n_residuals = static_cast<size_t>(cost.num_residuals());
  std::vector<const double*> pointers;
  std::vector<std::vector<double>> jacobians;
  std::vector<double*> jacobian_pointers;
  for (const auto& block : blocks) jacobians.emplace_back(n_residuals * block.size());
  for (size_t k = 0; k < blocks.size(); ++k) {
    pointers.push_back(blocks[k].data());
    jacobian_pointers.push_back(jacobians[k].data());
  }
  std::vector<double> residuals(n_residuals);
  ASSERT_TRUE(cost.Evaluate(pointers.data(), residuals.data(), jacobian_pointers.data()));
  for (size_t k = 0; k < blocks.size(); ++k) {
    const bool is_pose = blocks[k].size() == 7;
    const std::vector<double> at = blocks[k];
    for (size_t column = 0; column < (is_pose ? 6 : at.size()); ++column) {
      const double step = 1e-6 * std::max(1.0, is_pose ? 1.0 : std::abs(at[column]));
      std::vector<double> side[2];
      for (int s = 0; s < 2; ++s) {
        const double change = s == 0 ? step : -step;
        if (is_pose) {
          std::vector<double> delta(6, 0.0);
          delta[column] = change;
          ASSERT_TRUE(manifold.Plus(at.data(), delta.data(), blocks[k].data()));
        } else {
          blocks[k] = at;
          blocks[k][column] += change;
        }
        side[s].resize(n_residuals);
        ASSERT_TRUE(cost.Evaluate(pointers.data(), side[s].data(), nullptr));
      }
      std::copy(at.begin(), at.end(), blocks[k].begin());
      for (size_t r = 0; r < n_residuals; ++r) {
        const double expected = (side[0][r] - side[1][r]) / (2.0 * step);
        EXPECT_NEAR(jacobians[k][r * at.size() + column], expected, 1e-5 * std::max(1.0, std::abs(expected)))
            << "bundle " << k << ", row " << r << ", column " << column;
      }
    }
  }
}

std::vector<double> Numbers(const auto& array) {
  return {array.begin(), array.end()};
}

TEST(BundleCosts, ReprojectionHasTheDerivativesOfItsValue) {
  base::Random random(1);
  for (int k = 0; k < 20; ++k) {
    const Lens lens = {1200.0, 1.01, 800.0, 600.0, random.Uniform(-0.1, 0.1), random.Uniform(-0.05, 0.05), 1e-3, -2e-3};
    const std::vector<double> point = {random.Uniform(-20.0, 20.0), random.Uniform(-20.0, 20.0), random.Uniform(-5.0, 5.0)};
    ExpectDerivatives(ReprojectionCost({700.0, 500.0}, 2.0), {Numbers(RandomPose(random)), Numbers(lens), point});
  }
}

TEST(BundleCosts, ReprojectionByACameraOfARigHasTheDerivativesOfItsValue) {
  base::Random random(4);
  for (int k = 0; k < 20; ++k) {
    const Lens lens = {1200.0, 1.01, 800.0, 600.0, random.Uniform(-0.1, 0.1), random.Uniform(-0.05, 0.05), 1e-3, -2e-3};
    const std::vector<double> point = {random.Uniform(-20.0, 20.0), random.Uniform(-20.0, 20.0), random.Uniform(-5.0, 5.0)};
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(random.Uniform(-0.4, 0.4), Eigen::Vector3d(1.0, 2.0, -1.0).normalized()));
    const geo::Rigid3d cam_from_rig{turn, {0.3, -0.2, 0.5}};
    ExpectDerivatives(RigReprojectionCost(cam_from_rig, {700.0, 500.0}, 2.0), {Numbers(RandomPose(random)), Numbers(lens), point});
  }
}

TEST(BundleCosts, ACameraInTheFrameOfItsRigIsLikeOneAlone) {
  base::Random random(6);
  const Lens lens = {1200.0, 1.0, 800.0, 600.0, 0.05, 0.01, 1e-3, 0.0};
  const PoseNumbers pose = RandomPose(random);
  const std::vector<double> point = {1.0, 2.0, 3.0};
  const double* blocks[] = {pose.data(), lens.data(), point.data()};
  double alone[2], on_rig[2];
  ASSERT_TRUE(ReprojectionCost({700.0, 500.0}, 2.0).Evaluate(blocks, alone, nullptr));
  ASSERT_TRUE(RigReprojectionCost({}, {700.0, 500.0}, 2.0).Evaluate(blocks, on_rig, nullptr));
  EXPECT_NEAR(on_rig[0], alone[0], 1e-12);
  EXPECT_NEAR(on_rig[1], alone[1], 1e-12);
}

TEST(BundleCosts, TagsHaveTheDerivativesOfTheirValue) {
  base::Random random(2);
  for (int k = 0; k < 20; ++k) {
    const PoseNumbers pose = RandomPose(random);
    ExpectDerivatives(PlaceCost({1.0, 2.0, 70.0}, {3.0, 3.0, 5.0}), {Numbers(pose)});
    // From no turn at all to nearly half a turn.
    const Eigen::Vector3d axis = Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()}.normalized();
    const Eigen::Quaterniond tagged = Eigen::AngleAxisd(0.15 * k, axis) * Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(pose.data()));
    ExpectDerivatives(TurnCost(tagged, 0.05), {Numbers(pose)});
  }
}

TEST(BundleCosts, SharedShiftsAndKnownPointsHaveTheDerivativesOfTheirValue) {
  base::Random random(4);
  for (int k = 0; k < 20; ++k) {
    const std::vector<double> shift = {random.Normal(), random.Normal(), 20.0 * random.Normal()};
    ExpectDerivatives(ShiftedPlaceCost({1.0, 2.0, 70.0}, {3.0, 3.0, 5.0}), {Numbers(RandomPose(random)), shift});
    ExpectDerivatives(KnownPointCost({1.0, 2.0, 3.0}, {0.5, 0.25, 2.0}), {shift});
  }
}

TEST(BundleCosts, AnInfiniteSigmaLeavesItsAxisFree) {
  const KnownPointCost cost({1.0, 2.0, 0.0}, {0.5, 0.5, std::numeric_limits<double>::infinity()});
  const Eigen::Vector3d point(1.5, 2.0, 999.0);
  const double* parameters[] = {point.data()};
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> jacobian;
  double* jacobians[] = {jacobian.data()};
  ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
  EXPECT_EQ(residual, Eigen::Vector3d(1.0, 0.0, 0.0));
  EXPECT_EQ(jacobian, Eigen::Matrix3d(Eigen::Vector3d(2.0, 2.0, 0.0).asDiagonal()));
}

TEST(BundleCosts, LensPrior) {
  const Lens expected = {1200.0, 1.0, 800.0, 600.0, 0.0, 0.0, 0.0, 0.0}, sigma = {100.0, 0.01, 10.0, 10.0, 0.3, 0.3, 0.01, 0.01};
  const Lens at = {1300.0, 1.0, 800.0, 600.0, 0.3, 0.0, 0.0, 0.0};
  ExpectDerivatives(LensCost(expected, sigma), {Numbers(at)});
}

TEST(PoseManifold, MinusUndoesPlus) {
  const PoseManifold manifold;
  base::Random random(3);
  for (int k = 0; k < 50; ++k) {
    const PoseNumbers pose = RandomPose(random);
    std::array<double, 6> delta{}, back{};
    for (double& d : delta) d = random.Uniform(-1.0, 1.0);
    PoseNumbers moved{};
    ASSERT_TRUE(manifold.Plus(pose.data(), delta.data(), moved.data()));
    ASSERT_TRUE(manifold.Minus(moved.data(), pose.data(), back.data()));
    for (size_t i = 0; i < delta.size(); ++i) EXPECT_NEAR(back[i], delta[i], 1e-12);
  }
}

TEST(Lens, IsTheCameraOfEveryModel) {
  const std::vector<camera::Camera> cameras = {{camera::CameraModel::kSimplePinhole, 1600, 1200, {1200.0, 790.0, 610.0}},
                                               {camera::CameraModel::kPinhole, 1600, 1200, {1200.0, 1210.0, 790.0, 610.0}},
                                               {camera::CameraModel::kSimpleRadial, 1600, 1200, {1200.0, 790.0, 610.0, -0.05}},
                                               {camera::CameraModel::kRadial, 1600, 1200, {1200.0, 790.0, 610.0, -0.05, 0.02}},
                                               {camera::CameraModel::kOpencv, 1600, 1200, {1200.0, 1210.0, 790.0, 610.0, -0.05, 0.02, 1e-3, -2e-3}}};
  for (const camera::Camera& camera : cameras) {
    const auto lens = LensOf(camera);
    ASSERT_TRUE(lens);
    const camera::Camera back = CameraOf(*lens, camera);
    for (size_t k = 0; k < camera.params.size(); ++k) EXPECT_NEAR(back.params[k], camera.params[k], 1e-9);
    for (const double x : {-0.5, 0.0, 0.4}) {
      for (const double y : {-0.3, 0.2}) {
        const Eigen::Vector3d point(4.0 * x, 4.0 * y, 4.0);
        EXPECT_LT((Project(*lens, point, nullptr) - *camera.ImgFromCam(point)).norm(), 1e-9) << camera::ModelName(camera.model);
      }
    }
  }
  EXPECT_FALSE(LensOf({camera::CameraModel::kOpencvFisheye, 1600, 1200, std::vector<double>(8, 1.0)}));
}

TEST(Lens, HoldsWhatTheModelDoesNotHave) {
  const auto held = [](camera::CameraModel model, bool free_centre) {
    std::vector<int> numbers =
        HeldNumbers({model, 1600, 1200, std::vector<double>(static_cast<size_t>(camera::ModelParamCount(model)))}, free_centre);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
  };
  EXPECT_EQ(held(camera::CameraModel::kSimplePinhole, false), std::vector<int>({1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(held(camera::CameraModel::kPinhole, false), std::vector<int>({2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(held(camera::CameraModel::kSimpleRadial, false), std::vector<int>({1, 2, 3, 5, 6, 7}));
  EXPECT_EQ(held(camera::CameraModel::kRadial, true), std::vector<int>({1, 6, 7}));
  EXPECT_EQ(held(camera::CameraModel::kOpencv, false), std::vector<int>({2, 3}));
  EXPECT_EQ(held(camera::CameraModel::kRadialFisheye, false), std::vector<int>({1, 2}));
  EXPECT_EQ(held(camera::CameraModel::kFullOpencv, false), std::vector<int>({2, 3}));
  EXPECT_EQ(held(camera::CameraModel::kFullOpencv, true), std::vector<int>());
}

TEST(EntryTerm, OfACameraIsThatOfTheLens) {
  BundleProblem bundle;
  bundle.lenses = {{.camera = {camera::CameraModel::kOpencv, 1600, 1200, {1200.0, 1200.0, 790.0, 610.0, -0.05, 0.02, 1e-3, -2e-3}}, .unit_px = 2.0}};
  bundle.lenses[0].numbers = *LensOf(bundle.lenses[0].camera);
  const Eigen::Quaterniond down = prepare::poses::RotationFromAngles(30.0, -70.0, 5.0);
  bundle.photos = {{.cam_from_enu = down, .centre = down.conjugate() * Eigen::Vector3d(1.0, 2.0, -60.0), .placed = true}};
  bundle.tracks = {.first = {0, 1}, .entries = {{0, 0}}};
  bundle.pixel = {{700.0, 500.0}};
  const Eigen::Vector3d point(5.0, -3.0, 2.0);
  const auto expected = TermOf(bundle, 0, point);
  camera::Camera& camera = bundle.lenses[0].camera;
  camera.model = camera::CameraModel::kFullOpencv;
  camera.params.resize(12, 0.0);
  const auto term = TermOf(bundle, 0, point);
  EXPECT_LT((term.residual - expected.residual).norm(), 1e-9);
  EXPECT_LT((term.by_pose - expected.by_pose).norm(), 1e-6 * expected.by_pose.norm());
  EXPECT_LT((term.by_point - expected.by_point).norm(), 1e-6 * expected.by_point.norm());
  // The second number is fy there, and not fy / fx.
  EXPECT_LT((term.by_lens.middleCols<6>(2) - expected.by_lens.rightCols<6>()).norm(), 1e-6 * expected.by_lens.norm());
}

}  // namespace
}  // namespace skyquilt::test
