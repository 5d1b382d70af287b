// Photos that do not look down: a phone along a house front, along a street or in a room, and a drone round a building. They are level to within 24
// degrees, so that the ground, walls and the sky are in them. Stations are true; PlanLevelFlight adds what a hand does and what the tags have.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "simulate/flight.h"
#include "simulate/place_spec.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

inline constexpr double kEyeHeight_m = 1.6;
inline constexpr std::array<double, 2> kOrbitHeights_m = {10.0, 20.0};  // above the ground at the building

// Where a photo is taken: ENU metres, yaw clockwise from north, pitch 0 level and above 0 upwards.
struct LevelStation {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw_deg = 0.0;
  double pitch_deg = 0.0;
  int line = 0;  // photos of one line that follow each other overlap
};

// place.level_photos stations each, in the order of capture, in free space (simulate/flights/sight.h). An orbit leaves out those without free sight,
// with a warning. The others throw base::UsageError when the place has no room for them; so does an orbit that lacks half of its stations.
std::vector<LevelStation> FacadeStations(const PlaceSpec& place, const World& world);  // a line from one end of the longest front to the other
std::vector<LevelStation> OrbitStations(const PlaceSpec& place, const World& world);   // a line per height
std::vector<LevelStation> StreetStations(const PlaceSpec& place, const World& world);  // a line ahead, one to the left and one to the right
std::vector<LevelStation> RoomStations(const PlaceSpec& place);                        // one line

// The photos of place.flight, which is none of FlightKind::kSurvey. Tags as those of PlanFlight. Throws base::UsageError.
std::vector<PhotoPlan> PlanLevelFlight(const PlaceSpec& place, const World& world);

// Clockwise from north, of a direction to the east and the north.
double YawOf(const Eigen::Vector2d& direction);
// Height of the ground, ENU metres.
double GroundZ(const World& world, const Eigen::Vector2d& at);

}  // namespace skyquilt::simulate
