#include "simulate/lights.h"

#include <fmt/core.h>

namespace skyquilt::simulate {
namespace {

constexpr int kLowestSun_deg = 5, kHighestSun_deg = 85, kSunStep_deg = 5;
constexpr int kIntensities = 9;  // from 1 to 3
constexpr double kIntensityStep = 0.25;
constexpr double kPause_s = 600.0;  // between the flights of two lights

}  // namespace

std::vector<Light> PlanLights(const SimulateOptions& options, const PlaceSpec& place) {
  std::vector<Light> lights;
  if (options.lights == "sun") {
    for (int deg = kLowestSun_deg; deg <= kHighestSun_deg; deg += kSunStep_deg * options.lights_every) {
      lights.push_back({fmt::format("sun_{:02}", deg), static_cast<double>(deg), options.light_intensity});
    }
  } else if (options.lights == "intensity") {
    for (int i = 0; i < kIntensities; i += options.lights_every) {
      const double factor = 1.0 + kIntensityStep * i;
      lights.push_back({fmt::format("light_{:.2f}", factor), place.sun_elevation_deg, options.light_intensity * factor});
    }
  } else {
    lights.push_back({"", place.sun_elevation_deg, options.light_intensity});
  }
  return lights;
}

void RepeatUnder(const std::vector<Light>& lights, int test_every, std::vector<PhotoPlan>& photos) {
  if (lights.size() < 2 || photos.empty()) return;
  if (photos.size() > static_cast<size_t>(test_every)) photos.resize(photos.size() - photos.size() % static_cast<size_t>(test_every));
  const std::vector<PhotoPlan> flight = std::move(photos);
  const double flight_s = flight.back().time_s + kPause_s;
  photos.clear();
  for (size_t light = 0; light < lights.size(); ++light) {
    for (PhotoPlan photo : flight) {
      photo.name = lights[light].folder + "/" + photo.name;
      photo.time_s += static_cast<double>(light) * flight_s;
      photo.finds_points = photo.finds_points && light == 0;
      photos.push_back(std::move(photo));
    }
  }
}

}  // namespace skyquilt::simulate
