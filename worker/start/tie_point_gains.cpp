#include "worker/start/tie_point_gains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/image/srgb.h"
#include "core/linear/linear.h"
#include "core/survey/view_kind.h"
#include "worker/start/tie_point_shading.h"

namespace skyquilt::worker {
namespace {

// Points that are looked at: enough for every photo to have some hundred sightings, of which those of neighbours tie it to the others.
constexpr size_t kFewestPoints = 12'000, kPointsOfPhoto = 12;
constexpr size_t kPointsOfShadedPhoto = 60;  // shading needs some in every part of a photo
constexpr int kPointReach = 1;               // pixels on each side of a point's pixel that are averaged
constexpr int kFewestSightings = 8;          // points per photo: with fewer its gain is not estimated
constexpr size_t kSightingsOfKnot = 4;       // points per knot of a photo: with fewer its shading is learned in training, too
constexpr int kRounds = 6;                   // of reweighting
constexpr int kShadedRounds = 12;            // the same with shading: gains and shading are solved in turns
constexpr int kMostSteps = 200;              // of conjugate gradients
constexpr double kScatter = 0.15;            // residual in log light at which the weight of a sighting is halved
// With shading it begins this many times as large and shrinks by this factor every round: else the edge of a shadow would count as an outlier.
constexpr double kFirstScatter = 6.0, kScatterShrinks = 0.7;
constexpr double kVignettingExplains = 0.1;  // share of the squared residuals that vignetting must explain
constexpr double kNearlyAll = 0.95;          // share of the photos
constexpr double kVignettingRidge = 1.0;     // damping of vignetting, as a number of sightings
constexpr double kTrace = 1e-3;              // damping of gains, as a number of sightings

// One point in one photo. log_light: logarithm of the recorded light divided by the gain from tags.
struct Sighting {
  int point = 0, photo = 0;
  float radius2 = 0.0F;
  brightness::PicturePlace place = {0.0F, 0.0F};
  std::array<double, 3> log_light{};
};

Eigen::Vector3d Powers(float radius2) {
  const auto r2 = static_cast<double>(radius2);
  return {r2, r2 * r2, r2 * r2 * r2};
}

// Mean recorded light of the pixels around a position; false when one of them is outside the photo, masked, nearly black or saturated.
bool LightAround(const image::PixelCache& pixels, size_t photo, const Eigen::Vector2d& position, std::array<double, 3>* light) {
  const int x = static_cast<int>(position.x()), y = static_cast<int>(position.y());
  const int width = pixels.Width(photo), height = pixels.Height(photo);
  if (x < kPointReach || y < kPointReach || x >= width - kPointReach || y >= height - kPointReach) return false;
  *light = {0.0, 0.0, 0.0};
  for (int v = y - kPointReach; v <= y + kPointReach; ++v) {
    for (int u = x - kPointReach; u <= x + kPointReach; ++u) {
      uint8_t rgb[3];
      if (!pixels.Pixel(photo, static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u), rgb)) return false;
      for (size_t c = 0; c < 3; ++c) {
        if (rgb[c] < 3 || rgb[c] > 252) return false;
        (*light)[c] += static_cast<double>(image::LinearFromSrgb(static_cast<float>(rgb[c]) / 255.0F));
      }
    }
  }
  constexpr double kPixels = (2 * kPointReach + 1) * (2 * kPointReach + 1);
  for (double& value : *light) value /= kPixels;
  return true;
}

// A cone around all that a photo can show, so that of many photos and points most pairs need no projection.
class ViewCone {
 public:
  ViewCone(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu)
      : eye_(cam_from_enu.OriginInSource()), axis_(cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ()) {
    constexpr int kSteps = 8;
    constexpr double kSlack = 0.05;
    double least = 1.0;  // cosine of the widest angle from the axis
    for (int i = 0; i <= kSteps; ++i) {
      const double x = static_cast<double>(camera.width) * i / kSteps, y = static_cast<double>(camera.height) * i / kSteps;
      for (const Eigen::Vector2d& pixel :
           {Eigen::Vector2d(x, 0.0), Eigen::Vector2d(x, camera.height), Eigen::Vector2d(0.0, y), Eigen::Vector2d(camera.width, y)}) {
        least = std::min(least, camera.RayFromImg(pixel).normalized().z());
      }
    }
    least_cosine_ = least - kSlack;
  }
  bool MayShow(const Eigen::Vector3d& x_in_enu) const {
    const Eigen::Vector3d to = x_in_enu - eye_;
    return to.dot(axis_) >= least_cosine_ * to.norm();
  }

 private:
  Eigen::Vector3d eye_, axis_;
  double least_cosine_ = -1.0;
};

std::vector<Sighting> FindSightings(const survey::Survey& survey, const image::PixelCache& pixels, const RaySource& source,
                                    const brightness::Response& response, base::ThreadPool& threads) {
  const size_t of_photo = response.shading_grid.On() ? kPointsOfShadedPhoto : kPointsOfPhoto;
  const size_t wanted = std::max(kFewestPoints, of_photo * survey.photos.size());
  const size_t stride = std::max<size_t>(1, survey.points.size() / wanted);
  // From above, a photo sees nearly all points in its frame. Looking level, it sees many walls from behind: there only what it observed counts.
  const bool observed_only = !survey.tracks.Empty() && survey::LooksLevel(survey);
  std::vector<std::vector<Sighting>> per_photo(survey.photos.size());
  threads.ParallelFor(static_cast<int64_t>(survey.photos.size()), [&](int64_t task, int) {
    const auto photo = static_cast<size_t>(task);
    const survey::Photo& p = survey.photos[photo];
    if (p.is_test) return;
    const camera::Camera& camera = source.CameraOf(static_cast<int>(photo));
    const ViewCone cone(camera, p.cam_from_enu);
    for (size_t i = 0; i < survey.points.size(); i += stride) {
      if (observed_only && std::ranges::find(survey.tracks.PhotosOf(i), static_cast<int32_t>(photo)) == survey.tracks.PhotosOf(i).end()) continue;
      if (wanted > kFewestPoints && !cone.MayShow(survey.points[i].x_in_enu)) continue;
      const auto position = camera.ImgFromCam(p.cam_from_enu * survey.points[i].x_in_enu);
      std::array<double, 3> light{};
      if (!position || !(position->x() >= 0.0 && position->y() >= 0.0 && position->x() < camera.width && position->y() < camera.height)) continue;
      if (!LightAround(pixels, photo, *position, &light)) continue;
      Sighting sighting{static_cast<int>(i / stride),
                        static_cast<int>(photo),
                        source.Radius2(static_cast<int>(photo), *position),
                        source.PlaceOf(static_cast<int>(photo), *position),
                        {}};
      const double known = std::log(static_cast<double>(response.exif_gain[photo]));
      for (size_t c = 0; c < 3; ++c) sighting.log_light[c] = std::log(light[c]) - known;
      per_photo[photo].push_back(sighting);
    }
  });
  std::vector<Sighting> all;
  for (const auto& some : per_photo) all.insert(all.end(), some.begin(), some.end());
  std::stable_sort(all.begin(), all.end(), [](const Sighting& a, const Sighting& b) { return a.point < b.point; });
  return all;
}

// Calls each(first, last, mean) for every point with the range of its sightings and the weighted mean of a quantity over them.
template <typename Value, typename Each>
void ForEachPoint(std::span<const Sighting> sightings, const std::vector<double>& weight, const Value& value, const Each& each) {
  for (size_t first = 0, last = 0; first < sightings.size(); first = last) {
    double sum = 0.0;
    auto total = value(first);
    total *= 0.0;
    for (last = first; last < sightings.size() && sightings[last].point == sightings[first].point; ++last) {
      sum += weight[last];
      total += weight[last] * value(last);
    }
    total /= sum;
    each(first, last, total);
  }
}

// Log gains of one colour that minimise the weighted squares. The points' light is eliminated; the remaining system has an entry for every two photos
// that share a point, so it is solved by conjugate gradients without storing the matrix. Photos that do not learn keep their gains.
Eigen::VectorXd Solve(std::span<const Sighting> sightings, const std::vector<double>& weight, size_t colour, const brightness::LearnerOptions& learn,
                      const Eigen::VectorXd& before) {
  const Eigen::Index n = before.size();
  Eigen::VectorXd moves(n), damping(n), diagonal = Eigen::VectorXd::Zero(n);
  for (size_t s = 0; s < sightings.size(); ++s) diagonal[sightings[s].photo] += weight[s];
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto photo = static_cast<size_t>(i);
    moves[i] = learn.learns_gain[photo] != 0 ? 1.0 : 0.0;
    // Damping towards the tags' gains; a little even without tags, because the common factor of all photos is undetermined.
    damping[i] = kTrace + (learn.tag_weight.empty() ? 0.0 : static_cast<double>(learn.tag_weight[photo])) * diagonal[i];
  }
  // Per photo: weighted sum over its sightings of a quantity minus its mean over the point.
  const auto about_points = [&](const auto& value) {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(n);
    ForEachPoint(sightings, weight, value, [&](size_t first, size_t last, double mean) {
      for (size_t s = first; s < last; ++s) sums[sightings[s].photo] += weight[s] * (value(s) - mean);
    });
    return sums;
  };
  const auto apply = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return about_points([&](size_t s) { return x[sightings[s].photo]; }) + damping.cwiseProduct(x);
  };
  Eigen::VectorXd gains = before;
  Eigen::VectorXd rest = moves.cwiseProduct(about_points([&](size_t s) { return sightings[s].log_light[colour]; }) - apply(gains));
  const Eigen::VectorXd precondition = (diagonal + damping).cwiseInverse();
  Eigen::VectorXd scaled = precondition.cwiseProduct(rest), direction = scaled;
  const double enough = 1e-16 * std::max(1e-300, rest.dot(scaled));
  for (int step = 0; step < kMostSteps; ++step) {
    const double size = rest.dot(scaled);
    if (!(size > enough)) break;
    const Eigen::VectorXd image = moves.cwiseProduct(apply(direction));
    const double stride = size / direction.dot(image);
    gains += stride * direction;
    rest -= stride * image;
    scaled = precondition.cwiseProduct(rest);
    direction = scaled + rest.dot(scaled) / size * direction;
  }
  return gains;
}

// Fits the vignetting of every camera to the residuals of the gains, all colours together. It stays zero when it explains only a small part of the
// residuals, because reflection that depends on the viewing angle looks similar.
void SolveVignetting(std::span<const Sighting> sightings, const std::array<std::vector<double>, 3>& weight,
                     const std::array<Eigen::VectorXd, 3>& gains, size_t held, brightness::Response& response) {
  const size_t cameras = response.vignetting.size() / 3;
  std::vector<Eigen::Matrix3d> left(cameras, Eigen::Matrix3d::Identity() * kVignettingRidge);
  std::vector<Eigen::Vector3d> right(cameras, Eigen::Vector3d::Zero());
  std::vector<double> squares(cameras, 0.0);
  for (size_t c = 0; c < 3; ++c) {
    // Powers of the radius and residual log light, whose means over each point are subtracted below.
    const auto row = [&](size_t s) {
      Eigen::Vector4d values;
      values << Powers(sightings[s].radius2), sightings[s].log_light[c] - gains[c][sightings[s].photo];
      return values;
    };
    ForEachPoint(sightings, weight[c], row, [&](size_t first, size_t last, const Eigen::Vector4d& mean) {
      for (size_t s = first; s < last; ++s) {
        const auto camera = static_cast<size_t>(response.camera[static_cast<size_t>(sightings[s].photo)]);
        const Eigen::Vector4d off = row(s) - mean;
        left[camera] += weight[c][s] * off.head<3>() * off.head<3>().transpose();
        right[camera] += weight[c][s] * off[3] * off.head<3>();
        squares[camera] += weight[c][s] * off[3] * off[3];
      }
    });
  }
  for (size_t camera = held; camera < cameras; ++camera) {
    Eigen::Vector3d solved = linear::SolveSymmetric(left[camera], right[camera]);
    if (!(solved.dot(right[camera]) > kVignettingExplains * squares[camera])) solved.setZero();
    for (size_t k = 0; k < 3; ++k) response.vignetting[3 * camera + k] = static_cast<float>(solved[static_cast<Eigen::Index>(k)]);
  }
}

// For shading: what gains and vignetting leave, in the mean of the colours.
std::vector<ShadedSighting> WithoutOtherFactors(std::span<const Sighting> sightings, const std::array<std::vector<double>, 3>& weight,
                                                const std::array<Eigen::VectorXd, 3>& gains, const brightness::Response& response) {
  std::vector<ShadedSighting> shaded;
  shaded.reserve(sightings.size());
  for (size_t s = 0; s < sightings.size(); ++s) {
    const Sighting& sighting = sightings[s];
    ShadedSighting& one = shaded.emplace_back(ShadedSighting{sighting.point, sighting.photo, sighting.place});
    for (size_t c = 0; c < 3; ++c) {
      one.log_light += (sighting.log_light[c] - gains[c][sighting.photo]) / 3.0;
      one.weight += weight[c][s] / 3.0;
    }
    one.log_light -= static_cast<double>(response.LogVignetting(static_cast<size_t>(sighting.photo), sighting.radius2));
  }
  return shaded;
}

// Stores the gains of photos with enough points, and subtracts their mean when no photo anchors it.
bool KeepGains(const std::array<Eigen::VectorXd, 3>& gains, std::span<const Sighting> sightings, const brightness::LearnerOptions& learn,
               brightness::Response& response) {
  std::vector<int> count(response.photos(), 0);
  for (const Sighting& s : sightings) ++count[static_cast<size_t>(s.photo)];
  int wanted = 0, known = 0;
  for (size_t i = 0; i < response.photos(); ++i) {
    if (learn.learns_gain[i] == 0) continue;
    ++wanted;
    if (count[i] >= kFewestSightings) ++known;
  }
  for (size_t c = 0; c < 3; ++c) {
    double mean = 0.0, learning = 0.0;
    for (size_t i = 0; i < response.photos(); ++i) {
      if (learn.learns_gain[i] == 0) continue;
      float& gain = response.log_gain[3 * i + c];
      const auto limit = static_cast<double>(brightness::kMaxLogGain);
      if (count[i] >= kFewestSightings) gain = static_cast<float>(std::clamp(gains[c][static_cast<Eigen::Index>(i)], -limit, limit));
      mean += static_cast<double>(gain);
      learning += 1.0;
    }
    if (learn.anchored || learning == 0.0) continue;
    for (size_t i = 0; i < response.photos(); ++i) {
      if (learn.learns_gain[i] != 0) response.log_gain[3 * i + c] -= static_cast<float>(mean / learning);
    }
  }
  return !sightings.empty() && known >= kNearlyAll * wanted;
}

// Whether nearly all photos have enough points.
bool ShadingIsKnown(std::span<const Sighting> sightings, const brightness::ShadingOptions& shading) {
  std::vector<size_t> count(shading.learns.size(), 0);
  for (const Sighting& s : sightings) ++count[static_cast<size_t>(s.photo)];
  size_t wanted = 0, known = 0;
  for (size_t i = 0; i < count.size(); ++i) {
    if (shading.learns[i] == 0) continue;
    ++wanted;
    if (count[i] >= kSightingsOfKnot * shading.grid.knots()) ++known;
  }
  return static_cast<double>(known) >= kNearlyAll * static_cast<double>(wanted);
}

}  // namespace

KnownFromTiePoints GainsFromTiePoints(const survey::Survey& survey, const image::PixelCache& pixels, const RaySource& source,
                                      const brightness::LearnerOptions& learn, brightness::Response& response, base::ThreadPool& threads) {
  if (!learn.Gains() && !learn.vignetting && !learn.shading.On()) return {};
  const std::vector<Sighting> sightings = FindSightings(survey, pixels, source, response, threads);
  const auto n = static_cast<Eigen::Index>(survey.photos.size());
  std::array<Eigen::VectorXd, 3> gains;
  std::array<std::vector<double>, 3> weight;
  for (size_t c = 0; c < 3; ++c) {
    gains[c].resize(n);
    for (Eigen::Index i = 0; i < n; ++i) gains[c][i] = static_cast<double>(response.log_gain[3 * static_cast<size_t>(i) + c]);
    weight[c].assign(sightings.size(), 1.0);
  }
  std::vector<Sighting> flat = sightings;  // without vignetting
  std::vector<Sighting> unshaded = sightings;
  const bool shades = learn.shading.On();
  double scatter = shades ? kFirstScatter * kScatter : kScatter;
  for (int round = 0; round < (shades ? kShadedRounds : kRounds); ++round) {
    for (size_t s = 0; s < flat.size(); ++s) {
      const auto photo = static_cast<size_t>(flat[s].photo);
      const auto vignetting = static_cast<double>(response.LogVignetting(photo, flat[s].radius2));
      const auto shading = static_cast<double>(response.LogShading(photo, flat[s].place));
      for (size_t c = 0; c < 3; ++c) {
        unshaded[s].log_light[c] = sightings[s].log_light[c] - shading;
        flat[s].log_light[c] = unshaded[s].log_light[c] - vignetting;
      }
    }
    threads.ParallelFor(3, [&](int64_t colour, int) {
      const auto c = static_cast<size_t>(colour);
      gains[c] = Solve(flat, weight[c], c, learn, gains[c]);
      const auto light = [&](size_t s) { return flat[s].log_light[c] - gains[c][flat[s].photo]; };
      // Cauchy weights of the residuals from each point's mean.
      ForEachPoint(flat, weight[c], light, [&](size_t first, size_t last, double mean) {
        for (size_t s = first; s < last; ++s) {
          const double off = (light(s) - mean) / scatter;
          weight[c][s] = 1.0 / (1.0 + off * off);
        }
      });
    });
    if (learn.vignetting) SolveVignetting(unshaded, weight, gains, learn.held_vignetting, response);
    if (shades) SolveShading(WithoutOtherFactors(sightings, weight, gains, response), learn.shading, response);
    scatter = std::max(kScatter, kScatterShrinks * scatter);
  }
  const bool known = KeepGains(gains, sightings, learn, response);
  return {known, shades && ShadingIsKnown(sightings, learn.shading)};
}

}  // namespace skyquilt::worker
