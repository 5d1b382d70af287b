#include "prepare/bundle/adjust_bundle.h"

#include <ceres/ceres.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/cancel.h"
#include "prepare/bundle/bundle_costs.h"
#include "prepare/bundle/shots.h"

namespace skyquilt::prepare::bundle {
namespace {

class Watch : public ceres::IterationCallback {
 public:
  explicit Watch(const std::function<void()>& on_iteration) : on_iteration_(on_iteration) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    if (on_iteration_) on_iteration_();
    return base::CancelRequested() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const std::function<void()>& on_iteration_;
};

}  // namespace

// Photos that look straight down at level ground hardly tell the focal length from the height: there the tagged one, which is
// right to a few percent, must keep the height from being wrong by a quarter. Other photos outweigh it by far.
Lens LensSigma(const BundleLens& lens) {
  const double focal = lens.initial[0] * lens.focal_sigma;
  const double centre = 0.02 * lens.camera.width;
  return {focal, 0.01, centre, centre, 0.3, 0.3, 0.01, 0.01};
}

std::vector<int> HeldNumbersOf(const BundleLens& lens) {
  std::vector<int> held = HeldNumbers(lens.camera, lens.free_centre);
  if (lens.hold_focal) held.push_back(0);
  return held;
}

bool AdjustBundle(BundleProblem& bundle, std::span<const uint32_t> tracks, const BundleStage& stage, const std::function<void()>& on_iteration,
                  Eigen::Vector3d* shift) {
  // One for each photo, or for each shot of a rig: then the first photo's.
  std::vector<PoseNumbers> poses(bundle.photos.size());
  std::vector<uint32_t> pose_of(bundle.photos.size());
  std::iota(pose_of.begin(), pose_of.end(), 0U);
  const std::vector<Shot> shots = PlacedShots(bundle);
  std::vector<Lens> lenses;
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d new_shift = shift != nullptr ? *shift : Eigen::Vector3d::Zero();
  points.reserve(tracks.size());
  for (const BundleLens& lens : bundle.lenses) lenses.push_back(lens.numbers);
  for (size_t i = 0; i < poses.size(); ++i) {
    Eigen::Map<Eigen::Vector4d>(poses[i].data()) = bundle.photos[i].cam_from_enu.coeffs();
    Eigen::Map<Eigen::Vector3d>(poses[i].data() + 4) = bundle.photos[i].centre;
  }
  for (const Shot& shot : shots) {
    PoseNumbers& pose = poses[shot.photos.front()];
    Eigen::Map<Eigen::Vector4d>(pose.data()) = shot.pose.rig_from_enu.coeffs();
    Eigen::Map<Eigen::Vector3d>(pose.data() + 4) = shot.pose.centre;
    for (const uint32_t photo : shot.photos) pose_of[photo] = shot.photos.front();
  }

  // Must outlive the problem, which does not own them.
  PoseManifold pose_manifold;
  std::unique_ptr<ceres::LossFunction> loss;
  if (stage.gentle) {
    loss = std::make_unique<ceres::HuberLoss>(stage.loss);
  } else {
    loss = std::make_unique<ceres::CauchyLoss>(stage.loss);
  }
  ceres::CauchyLoss tag_loss(kTagLoss);
  ceres::HuberLoss known_loss(stage.known_loss);
  std::unordered_map<uint32_t, const KnownPoint*> known;
  for (const KnownPoint& point : stage.known) known.emplace(point.track, &point);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  std::vector<std::unique_ptr<ceres::SubsetManifold>> lens_manifolds;
  ceres::Problem problem(problem_options);
  // Points are eliminated first. Poses and lenses have groups of their own, as parameter blocks of one group are ordered by their addresses.
  constexpr int kPointGroup = 0, kPoseGroup = 1, kLensGroup = 2, kShiftGroup = 3;
  const auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  ceres::Solver::Options options;
  options.linear_solver_ordering = ordering;

  std::vector<char> sees(bundle.photos.size(), 0), used(bundle.lenses.size(), 0);
  for (const uint32_t t : tracks) {
    if (bundle.has_point[t] == 0) continue;
    points.push_back(bundle.point[t]);
    double* point = points.back().data();
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      const uint32_t photo = bundle.tracks.entries[e].photo;
      if (bundle.agrees[e] == 0 || !bundle.photos[photo].placed) continue;
      const auto lens = static_cast<size_t>(bundle.photos[photo].lens);
      const double sigma_px = bundle.lenses[lens].unit_px * (bundle.sigma.empty() ? 1.0 : bundle.sigma[e]);
      const uint32_t pose = pose_of[photo];
      ceres::CostFunction* cost =
          bundle.photos[photo].shot < 0
              ? static_cast<ceres::CostFunction*>(new ReprojectionCost(bundle.pixel[e], sigma_px))
              : static_cast<ceres::CostFunction*>(new RigReprojectionCost(bundle.photos[photo].cam_from_rig, bundle.pixel[e], sigma_px));
      problem.AddResidualBlock(cost, loss.get(), poses[pose].data(), lenses[lens].data(), point);
      sees[pose] = 1;
      used[lens] = 1;
    }
    if (!problem.HasParameterBlock(point)) continue;
    ordering->AddElementToGroup(point, kPointGroup);
    if (const auto found = known.find(t); found != known.end()) {
      problem.AddResidualBlock(new KnownPointCost(found->second->place, found->second->sigma), &known_loss, point);
    }
  }
  for (size_t i = 0; i < poses.size(); ++i) {
    if (sees[i] == 0) continue;
    const BundlePhoto photo = TagsOfPose(bundle, shots, static_cast<uint32_t>(i));
    problem.SetManifold(poses[i].data(), &pose_manifold);
    ordering->AddElementToGroup(poses[i].data(), kPoseGroup);
    if (photo.held) {
      problem.SetParameterBlockConstant(poses[i].data());
      continue;
    }
    if (photo.gps && shift != nullptr) {
      problem.AddResidualBlock(new ShiftedPlaceCost(*photo.gps, stage.gps_factor * photo.gps_sigma), &tag_loss, poses[i].data(), new_shift.data());
    } else if (photo.gps) {
      problem.AddResidualBlock(new PlaceCost(*photo.gps, stage.gps_factor * photo.gps_sigma), &tag_loss, poses[i].data());
    }
    if (photo.tagged_rotation) {
      const double sigma_rad = stage.angle_sigma_deg * std::numbers::pi / 180.0;
      problem.AddResidualBlock(new TurnCost(*photo.tagged_rotation, sigma_rad), &tag_loss, poses[i].data());
    }
  }
  if (problem.HasParameterBlock(new_shift.data())) ordering->AddElementToGroup(new_shift.data(), kShiftGroup);
  for (size_t i = 0; i < lenses.size(); ++i) {
    if (used[i] == 0) continue;
    ordering->AddElementToGroup(lenses[i].data(), kLensGroup);
    if (!stage.free_lens || bundle.lenses[i].exact) {
      problem.SetParameterBlockConstant(lenses[i].data());
      continue;
    }
    lens_manifolds.push_back(std::make_unique<ceres::SubsetManifold>(8, HeldNumbersOf(bundle.lenses[i])));
    problem.SetManifold(lenses[i].data(), lens_manifolds.back().get());
    if (stage.lens_prior) problem.AddResidualBlock(new LensCost(bundle.lenses[i].initial, LensSigma(bundle.lenses[i])), nullptr, lenses[i].data());
  }
  if (problem.NumResidualBlocks() == 0) return false;

  // As COLMAP: direct solutions while the cameras' normal equations are small enough to be factored.
  constexpr size_t kMaxDense = 50, kMaxDirect = 4000;
  options.linear_solver_type = poses.size() <= kMaxDense    ? ceres::DENSE_SCHUR
                               : poses.size() <= kMaxDirect ? ceres::SPARSE_SCHUR
                                                            : ceres::ITERATIVE_SCHUR;
  options.preconditioner_type = ceres::SCHUR_JACOBI;
  options.num_threads = 1;
  options.max_num_iterations = stage.max_iterations;
  options.function_tolerance = stage.tolerance;
  options.logging_type = ceres::SILENT;
  Watch watch(on_iteration);
  options.callbacks.push_back(&watch);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  base::ThrowIfCancelled();
  if (!summary.IsSolutionUsable()) return false;

  for (const Shot& shot : shots) {
    const uint32_t first = shot.photos.front();
    if (std::exchange(sees[first], 0) == 0) continue;
    const PoseNumbers& pose = poses[first];
    const RigPose adjusted{Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(pose.data())), Eigen::Map<const Eigen::Vector3d>(pose.data() + 4)};
    for (const uint32_t photo : shot.photos) PlaceByRig(adjusted, bundle.photos[photo]);
  }
  for (size_t i = 0; i < poses.size(); ++i) {
    if (sees[i] == 0 || bundle.photos[i].held) continue;
    bundle.photos[i].cam_from_enu = Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(poses[i].data()));
    bundle.photos[i].centre = Eigen::Map<const Eigen::Vector3d>(poses[i].data() + 4);
  }
  for (size_t i = 0; i < lenses.size(); ++i) bundle.lenses[i].numbers = lenses[i];
  if (shift != nullptr) *shift = new_shift;
  size_t k = 0;
  for (const uint32_t t : tracks) {
    if (bundle.has_point[t] != 0) bundle.point[t] = points[k++];
  }
  return true;
}

}  // namespace skyquilt::prepare::bundle
