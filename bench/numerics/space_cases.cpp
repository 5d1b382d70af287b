// A position goes from latitude, longitude and height through ENU into a block's unit box, is rounded to float there once, and goes back. The error
// is measured against long double.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/numerics/geodesy.h"
#include "bench/numerics/groups.h"
#include "core/base/random.h"
#include "core/encoding/space_map.h"
#include "core/geo/enu_frame.h"
#include "core/geo/transform.h"
#include "core/page/curve_chart.h"
#include "core/render/march.h"

namespace skyquilt::bench {
namespace {

constexpr double kBlock_m = 250.0;  // a typical block
constexpr double kMarginShare = 0.06;
constexpr double kBlockHeight_m = 60.0;
constexpr double kAllowed_mm = 1.0;

std::string LengthText(double length_m) {
  return length_m < 1e3 ? fmt::format("{:g} m", length_m) : fmt::format("{:g} km", length_m / 1e3);
}

// The box, with margin, of the grid block that contains a position.
encoding::SpaceMap BlockAround(const Eigen::Vector3d& x_in_enu, double side_m) {
  const double margin = kMarginShare * side_m;
  const double height = std::min(side_m, kBlockHeight_m);
  const Eigen::Vector3d low(std::floor(x_in_enu.x() / side_m) * side_m - margin, std::floor(x_in_enu.y() / side_m) * side_m - margin,
                            std::floor(x_in_enu.z() / height) * height);
  return encoding::SpaceMap::Box(low, low + Eigen::Vector3d(side_m + 2.0 * margin, side_m + 2.0 * margin, height));
}

geo::Geodetic ThroughThePipeline(const geo::EnuFrame& frame, const geo::Geodetic& place, double side_m) {
  const Eigen::Vector3d enu = frame.EnuFromGeodetic(place);
  const encoding::SpaceMap block = BlockAround(enu, side_m);
  const Eigen::Vector3f unit = block.UnitFromEnu(enu);
  return frame.GeodeticFromEnu(block.EnuFromUnit(unit.cast<double>()));
}

// Largest error over random positions of a survey of this extent.
double WorstRoundTripMm(const geo::Geodetic& origin, double extent_m, int places) {
  const geo::EnuFrame frame(origin);
  base::Random random(17);
  Worst worst;
  for (int i = 0; i < places; ++i) {
    const double up = 0.5 * std::min(extent_m, 2.0 * kBlockHeight_m);
    const double enu_z = random.Uniform(-up, up), enu_y = random.Uniform(-0.5, 0.5) * extent_m, enu_x = random.Uniform(-0.5, 0.5) * extent_m;
    const Eigen::Vector3d enu(enu_x, enu_y, enu_z);
    const geo::Geodetic place = frame.GeodeticFromEnu(enu);
    worst.Take(1e3 * DistanceMetres(place, ThroughThePipeline(frame, place, std::min(extent_m, kBlock_m))));
  }
  return worst.value();
}

NumericCase PlaceCase(const std::string& name, const geo::Geodetic& origin, int places) {
  return {.name = name,
          .expected = "moved by at most 1 mm, surveys of 1 m, 1 km and 100 km",
          .unit = "mm",
          .limit = kAllowed_mm,
          .run = [origin, places] {
            CaseResult finding;
            Worst over_all;
            for (const double extent : {1.0, 1e3, 1e5}) {
              const double worst = WorstRoundTripMm(origin, extent, places);
              finding.seen += fmt::format("{}{}: {}", finding.seen.empty() ? "" : ", ", LengthText(extent), FormatError(worst, "mm"));
              over_all.Take(worst);
            }
            finding.worst = over_all.value();
            return finding;
          }};
}

// A camera up to 70 km from the origin looks at a block: unit-box positions of samples on its rays, against long double.
CaseResult RaySamples() {
  base::Random random(23);
  Worst worst;
  for (int i = 0; i < 2000; ++i) {
    const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const double distance = std::pow(10.0, random.Uniform(1.0, 4.85));
    const Eigen::Vector3d aim(distance * std::cos(angle), distance * std::sin(angle), random.Uniform(1.0, 40.0));
    geo::Rigid3d cam_from_enu;
    const double z = random.Normal(), y = random.Normal(), x = random.Normal(), w = random.Normal();
    cam_from_enu.rotation = Eigen::Quaterniond(w, x, y, z).normalized();
    const double up = random.Uniform(50, 150), north = random.Uniform(-90, 90), east = random.Uniform(-90, 90);
    const Eigen::Vector3d centre = aim + Eigen::Vector3d(east, north, up);
    cam_from_enu.translation = -(cam_from_enu.rotation * centre);
    const Eigen::Vector3d origin = cam_from_enu.Inverse().translation;
    const Eigen::Vector3d direction = (aim - centre).normalized();
    const double t = (aim - centre).norm() * random.Uniform(0.98, 1.02);
    const encoding::SpaceMap block = BlockAround(aim, kBlock_m);
    const Eigen::Vector3d seen = block.EnuFromUnit(render::UnitRay(block, origin, direction).At(t).cast<double>());
    const Vector3L exact = centre.cast<long double>() + static_cast<long double>(t) * direction.cast<long double>();
    const auto error = static_cast<double>((seen.cast<long double>() - exact).norm());
    worst.Take(1e3 * error);
  }
  return {.seen = "cameras up to 70 km from the origin, 2000 samples", .worst = worst.value()};
}

// A float in [0.5, 1) has steps of 2^-24, and rounds by at most half of one.
NumericCase BoxStepCase(double edge_m) {
  const double half_step_mm = 1e3 * edge_m * std::exp2(-25.0);
  return {.name = "Block of " + LengthText(edge_m),
          .expected = fmt::format("half a float step per axis: {}{}", FormatError(half_step_mm, "mm"),
                                  half_step_mm > 0.5 ? "; blocks are never this large" : ""),
          .unit = "mm",
          .limit = half_step_mm * 1.0001,
          .run = [edge_m] {
            base::Random random(31);
            const encoding::SpaceMap map =
                encoding::SpaceMap::Box({-0.3 * edge_m, 1.7 * edge_m, -4.0}, {0.7 * edge_m, 2.7 * edge_m, -4.0 + std::min(60.0, edge_m)});
            Worst worst;
            for (int i = 0; i < 20000; ++i) {
              const double north = map.min_enu().y() + random.UniformDouble() * edge_m;
              const double east = map.min_enu().x() + random.UniformDouble() * edge_m;
              const Eigen::Vector3d x(east, north, -3.5);
              worst.Take(1e3 * (map.EnuFromUnit(map.UnitFromEnu(x).cast<double>()) - x).cwiseAbs().maxCoeff());
            }
            return CaseResult{.seen = "worst axis of 20000 places", .worst = worst.value()};
          }};
}

NumericCase NaiveCase(NaiveFrame frame) {
  return {.name = "Instead: " + NaiveName(frame),
          .expected = "a survey of 100 km at 47\xC2\xB0 N, coordinates rounded to float",
          .unit = "mm",
          .for_comparison = true,
          .run = [frame] {
            const geo::Geodetic origin{47.3769, 8.5417, 408.0};
            const geo::EnuFrame enu(origin);
            base::Random random(41);
            Worst worst;
            double sum = 0.0;
            constexpr int kPlaces = 2000;
            for (int i = 0; i < kPlaces; ++i) {
              const geo::Geodetic place = enu.GeodeticFromEnu({random.Uniform(-5e4, 5e4), random.Uniform(-5e4, 5e4), random.Uniform(-60.0, 60.0)});
              const double error = 1e3 * NaiveErrorMetres(frame, origin, place);
              worst.Take(error);
              sum += error;
            }
            return CaseResult{.seen = "on average " + FormatError(sum / kPlaces, "mm"), .worst = worst.value()};
          }};
}

// Largest error of positions on circles around the origin.
std::vector<std::string> ErrorAgainstDistance() {
  const geo::Geodetic origin{47.3769, 8.5417, 408.0};
  const geo::EnuFrame frame(origin);
  std::vector<page::Curve> curves(1 + NaiveFrames().size());
  curves[0].name = "Skyquilt (blocks of 250 m)";
  curves[0].emphasised = true;
  for (size_t k = 0; k < NaiveFrames().size(); ++k) curves[k + 1].name = NaiveName(NaiveFrames()[k]);
  base::Random random(47);
  for (double exponent = 0.0; exponent < 6.01; exponent += 0.25) {
    const double distance = std::pow(10.0, exponent);
    std::vector<double> worst(curves.size(), 0.0);
    for (int i = 0; i < 300; ++i) {
      const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
      const geo::Geodetic place = frame.GeodeticFromEnu({distance * std::cos(angle), distance * std::sin(angle), random.Uniform(0.0, 50.0)});
      worst[0] = std::max(worst[0], 1e3 * DistanceMetres(place, ThroughThePipeline(frame, place, kBlock_m)));
      for (size_t k = 0; k < NaiveFrames().size(); ++k) {
        worst[k + 1] = std::max(worst[k + 1], 1e3 * NaiveErrorMetres(NaiveFrames()[k], origin, place));
      }
    }
    for (size_t k = 0; k < curves.size(); ++k) curves[k].points.emplace_back(distance, worst[k]);
  }
  return {page::CurveChart(curves, {.title = "How far rounding moves a place",
                                    .x_label = "distance from the survey's origin, m",
                                    .y_label = "worst error, mm",
                                    .log_y = true,
                                    .log_x = true})};
}

}  // namespace

NumericGroup SpaceGroup(const NumericsOptions& options) {
  const int places = options.quick ? 300 : 2000;
  NumericGroup group{.id = "space",
                     .title = "Space",
                     .lead =
                         "A position goes from latitude, longitude and height through the survey's ENU frame (double) into its block's unit box "
                         "(float, rounded once) and back; the error is measured in Earth-centred long double. Surveys of 1 m are one block of 1 m, "
                         "the others are divided into blocks of 250 m.",
                     .cases = {},
                     .charts = ErrorAgainstDistance};
  for (int latitude = -90; latitude <= 90; latitude += 15) {
    const std::string name = latitude == 90 ? "North pole" : latitude == -90 ? "South pole" : fmt::format("Latitude {}\xC2\xB0", latitude);
    group.cases.push_back(PlaceCase(name, {static_cast<double>(latitude), 8.5417, 100.0}, places));
  }
  group.cases.push_back(
      PlaceCase("Across \xC2\xB1"
                "180\xC2\xB0 on the equator",
                {0.0, 180.0, 2.0}, places));
  group.cases.push_back(
      PlaceCase("Across \xC2\xB1"
                "180\xC2\xB0 at 68.9\xC2\xB0 N",
                {68.9, -180.0, 300.0}, places));
  group.cases.push_back(PlaceCase("Ten metres from the north pole", {89.9999, 37.0, 0.0}, places));
  group.cases.push_back(PlaceCase("Below sea level (-430 m)", {31.5, 35.5, -430.0}, places));
  group.cases.push_back(PlaceCase("At 9 km height", {27.9881, 86.925, 9000.0}, places));
  group.cases.push_back(
      {.name = "Samples along rays", .expected = "at most 1 mm from where they should be", .unit = "mm", .limit = kAllowed_mm, .run = RaySamples});
  for (const double edge_m : {1.0, 250.0, 1e3, 1e5}) group.cases.push_back(BoxStepCase(edge_m));
  for (const NaiveFrame frame : NaiveFrames()) group.cases.push_back(NaiveCase(frame));
  return group;
}

}  // namespace skyquilt::bench
