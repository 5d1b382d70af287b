#include "worker/poses/pose_learner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/order_statistics.h"
#include "core/checkpoint/take_array.h"
#include "core/geo/pose_gauge.h"

namespace skyquilt::worker {
namespace {

// Course of the rate, by the share of the budget: rises from kBegin to kFullRate, falls geometrically from kFallFrom on.
constexpr double kFullRate = 0.15, kFallFrom = 0.4, kLastRateShare = 0.05;
constexpr double kBeta1 = 0.9, kBeta2 = 0.99, kEpsilon = 1e-15;
// Of an offset of one sigma; by trials (docs/benchmarks.md). With a sigma of 2 pixels it is about a tenth of what a pixel of misplacement costs, so
// that the prior decides only where photos say little.
constexpr double kPriorLoss = 8e-4;
// Enough sparse points to tell how far away photos look.
constexpr size_t kPointsToTry = 2000, kFewestPoints = 10;

Eigen::Map<const PoseVector> VectorAt(const std::vector<double>& values, size_t photo) {
  return Eigen::Map<const PoseVector>(values.data() + 6 * photo);
}

Eigen::Map<PoseVector> VectorAt(std::vector<double>& values, size_t photo) {
  return Eigen::Map<PoseVector>(values.data() + 6 * photo);
}

survey::PoseOffset OffsetOf(const PoseVector& x) {
  return {x.head<3>(), x.tail<3>()};
}

// Median distance along the axis of the sparse points in each photo's view; where there are few, its height above ground, or that of others.
std::vector<double> DistancesOf(const survey::Survey& survey) {
  const size_t every = std::max<size_t>(1, survey.points.size() / kPointsToTry);
  std::vector<double> distances(survey.photos.size(), 0.0), known;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    std::vector<double> seen;
    for (size_t p = 0; p < survey.points.size(); p += every) {
      const Eigen::Vector3d x = photo.cam_from_enu * survey.points[p].x_in_enu;
      if (!(x.z() > 0.0)) continue;
      const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(x);
      if (pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= camera.width && pixel->y() <= camera.height) seen.push_back(x.z());
    }
    if (seen.size() >= kFewestPoints) {
      distances[i] = base::Median(std::move(seen));
    } else if (photo.agl_m > 0.0) {
      distances[i] = photo.agl_m;
    }
    if (distances[i] > 0.0) known.push_back(distances[i]);
  }
  const double usual = known.empty() ? 1.0 : base::Median(std::move(known));
  for (double& distance : distances) distance = distance > 0.0 ? distance : usual;
  return distances;
}

}  // namespace

PoseLearner::PoseLearner(const survey::Survey& survey, const RaySource& source, const PoseLearnerOptions& options) : options_(options) {
  if (!On()) return;
  const std::vector<double> distances = DistancesOf(survey);
  arm_m_ = base::Median(distances);
  whitening_.resize(survey.photos.size());
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    given_.push_back(survey.photos[i].cam_from_enu.Inverse());
    if (!survey.photos[i].is_test) whitening_[i] = WhitenPose(source.CameraOf(static_cast<int>(i)), distances[i]);
  }
  for (auto* values : {&state_.offsets, &state_.gradient, &state_.moment1, &state_.moment2}) values->assign(6 * survey.photos.size(), 0.0);
  for (auto* counts : {&state_.rays, &state_.steps}) counts->assign(survey.photos.size(), 0);
  state_.moved_px.assign(survey.photos.size(), 0.0);
}

std::vector<float> PoseLearner::LevelShares(double progress, int parts) {
  const double course = std::clamp((progress - kBegin) / (kAllLevels - kBegin), 0.0, 1.0);
  const double levels = 0.5 * parts * (1.0 + course);
  std::vector<float> shares;
  for (int part = 0; part < parts; ++part) {
    // BARF, eq. 14.
    const double share = parts == 1 ? 1.0 : std::clamp(levels - part, 0.0, 1.0);
    shares.push_back(static_cast<float>(0.5 - 0.5 * std::cos(std::numbers::pi * share)));
  }
  return shares;
}

// A pose (R, c) = (given_R exp(w), given_c + given_R tau) sends its rays in the directions R r: a turn d in the camera's present axes changes them by
// R (d x r), and d = J w for small changes of w with the right Jacobian J.
void PoseLearner::Add(const PixelRay& ray, const RayGradient& gradient, double ray_share) {
  const auto photo = static_cast<size_t>(ray.photo);
  const Eigen::Vector3d w = VectorAt(state_.offsets, photo).head<3>();
  const Eigen::Quaterniond cam_from_enu = (given_[photo].rotation * geo::RotationOfVector(w)).conjugate();
  const Eigen::Vector3d r = cam_from_enu * ray.direction_enu, by_r = cam_from_enu * gradient.by_direction;
  PoseVector by_offset;
  by_offset.head<3>() = geo::RightJacobianOfRotation(w).transpose() * r.cross(by_r);
  by_offset.tail<3>() = given_[photo].rotation.conjugate() * gradient.by_origin;
  VectorAt(state_.gradient, photo) += whitening_[photo].parameters_of_phi.lazyProduct(by_offset / ray_share);
  ++state_.rays[photo];
}

void PoseLearner::Step(double progress, RaySource& source) {
  if (!ActiveAt(progress)) return;
  const double rise = std::clamp((progress - kBegin) / (kFullRate - kBegin), 0.01, 1.0);
  const double fall = std::pow(kLastRateShare, std::clamp((progress - kFallFrom) / (1.0 - kFallFrom), 0.0, 1.0));
  const double rate = options_.rate_px * rise * fall;
  bool moved = false;
  for (size_t photo = 0; photo < given_.size(); ++photo) {
    if (state_.rays[photo] < kRaysPerUpdate) continue;
    auto offset = VectorAt(state_.offsets, photo);
    const PoseVector squared = whitening_[photo].squared_pixels.diagonal();
    const PoseVector by_prior = 2.0 * kPriorLoss / (options_.sigma_px * options_.sigma_px) *
                                whitening_[photo].parameters_of_phi.lazyProduct(squared.cwiseProduct(offset).eval());
    const PoseVector gradient = VectorAt(state_.gradient, photo) / static_cast<double>(state_.rays[photo]) + by_prior;
    VectorAt(state_.gradient, photo).setZero();
    state_.rays[photo] = 0;
    if (!gradient.allFinite()) continue;
    const auto t = static_cast<double>(++state_.steps[photo]);
    auto m1 = VectorAt(state_.moment1, photo), m2 = VectorAt(state_.moment2, photo);
    m1 = kBeta1 * m1 + (1.0 - kBeta1) * gradient;
    m2 = kBeta2 * m2 + (1.0 - kBeta2) * gradient.cwiseAbs2();
    const double correction1 = 1.0 - std::pow(kBeta1, t), correction2 = 1.0 - std::pow(kBeta2, t);
    const PoseVector step = (m1 / correction1).array() / ((m2 / correction2).array().sqrt() + kEpsilon);
    offset -= rate * whitening_[photo].parameters_of_phi.lazyProduct(step);
    moved = true;
  }
  if (!moved) return;
  TakeGaugeOff();
  Tell(source);
}

// Photos that made no step count as nothing, and stay.
void PoseLearner::TakeGaugeOff() {
  std::vector<geo::Rigid3d> changed;
  std::vector<double> weights;
  for (size_t photo = 0; photo < given_.size(); ++photo) {
    changed.push_back(survey::WithOffset(given_[photo], OffsetOf(VectorAt(state_.offsets, photo))));
    weights.push_back(state_.steps[photo] > 0 ? 1.0 : 0.0);
  }
  geo::RemoveSimilarity(given_, weights, arm_m_, changed);
  for (size_t photo = 0; photo < given_.size(); ++photo) {
    if (state_.steps[photo] == 0) continue;
    const survey::PoseOffset offset = survey::OffsetBetween(given_[photo], changed[photo]);
    auto x = VectorAt(state_.offsets, photo);
    x << offset.rotation, offset.translation;
    state_.moved_px[photo] = whitening_[photo].MovedPixels(x);
  }
}

void PoseLearner::Tell(RaySource& source) const {
  for (size_t photo = 0; photo < given_.size(); ++photo) {
    if (state_.steps[photo] > 0) {
      source.SetPose(static_cast<int>(photo), survey::WithOffset(given_[photo], OffsetOf(VectorAt(state_.offsets, photo))));
    } else {
      source.SetPose(static_cast<int>(photo), given_[photo]);
    }
  }
}

void PoseLearner::Put(checkpoint::ArchiveWriter& writer) const {
  if (!On()) return;
  const std::vector<int64_t> shape = {static_cast<int64_t>(given_.size()), 6};
  writer.Put("poses/offsets", state_.offsets, shape);
  writer.Put("poses/gradient", state_.gradient, shape);
  writer.Put("poses/moment1", state_.moment1, shape);
  writer.Put("poses/moment2", state_.moment2, shape);
  writer.Put("poses/rays", state_.rays);
  writer.Put("poses/steps", state_.steps);
  writer.Put("poses/moved_px", state_.moved_px);
}

void PoseLearner::Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  if (!On()) return;
  const auto take = [&](auto& to, const auto& from, const char* name) { checkpoint::TakeArray(from, name, file, "survey", to); };
  take(state_.offsets, reader.Doubles("poses/offsets"), "poses/offsets");
  take(state_.gradient, reader.Doubles("poses/gradient"), "poses/gradient");
  take(state_.moment1, reader.Doubles("poses/moment1"), "poses/moment1");
  take(state_.moment2, reader.Doubles("poses/moment2"), "poses/moment2");
  take(state_.rays, reader.Ints("poses/rays"), "poses/rays");
  take(state_.steps, reader.Ints("poses/steps"), "poses/steps");
  take(state_.moved_px, reader.Doubles("poses/moved_px"), "poses/moved_px");
}

survey::RefinedPoses RefinedPosesOf(const PoseLearner::State& state, const survey::Survey& survey) {
  survey::RefinedPoses poses;
  for (size_t photo = 0; photo < state.steps.size(); ++photo) {
    if (state.steps[photo] > 0) poses.photos.push_back({survey.photos[photo].name, OffsetOf(VectorAt(state.offsets, photo)), state.moved_px[photo]});
  }
  return poses;
}

std::optional<survey::RefinedPoses> ReadRefinedPoses(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file,
                                                     const survey::Survey& survey) {
  if (!reader.Has("poses/offsets")) return std::nullopt;
  PoseLearner::State state;
  state.offsets.resize(6 * survey.photos.size());
  state.steps.resize(survey.photos.size());
  state.moved_px.resize(survey.photos.size());
  checkpoint::TakeArray(reader.Doubles("poses/offsets"), "poses/offsets", file, "survey", state.offsets);
  checkpoint::TakeArray(reader.Ints("poses/steps"), "poses/steps", file, "survey", state.steps);
  checkpoint::TakeArray(reader.Doubles("poses/moved_px"), "poses/moved_px", file, "survey", state.moved_px);
  return RefinedPosesOf(state, survey);
}

}  // namespace skyquilt::worker
