// Plan of a simulated city: a grid of streets, the cells between them, and the contents of each cell. East and north only; heights are added later,
// from the terrain.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "simulate/building.h"
#include "simulate/car.h"
#include "simulate/place_spec.h"
#include "simulate/tree.h"

namespace skyquilt::simulate {

enum class CellKind { kHouses, kFlats, kTowers, kPark, kField };
enum class PadKind { kDriveway, kPath, kParking, kTerrace, kPlaza };

// A paved rectangle on the ground.
struct PavedArea {
  PadKind kind = PadKind::kPath;
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();
  Eigen::Vector2f half = Eigen::Vector2f::Ones();  // half sizes along its own axes
  float cosine = 1.0F;                             // of its yaw
  float sine = 0.0F;
  Eigen::Vector2f Local(float east, float north) const {
    const float x = east - centre.x();
    const float y = north - centre.y();
    return {cosine * x + sine * y, cosine * y - sine * x};
  }
};

struct Cell {
  CellKind kind = CellKind::kHouses;
  Eigen::Vector2d min = Eigen::Vector2d::Zero();  // inside the pavements, ENU metres
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  std::vector<PavedArea> pads;
  float lot_pitch_m = 1e6F;  // width of a garden along east
};

struct Pond {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d radii = Eigen::Vector2d::Ones();
  double level_z_m = 0.0;
  // Relative distance from the centre: 0 at the centre, 1 at the shore.
  double Radius(double east, double north) const { return std::hypot((east - centre.x()) / radii.x(), (north - centre.y()) / radii.y()); }
};

struct CityContents {
  std::vector<Building> buildings;
  std::vector<Tree> trees;
  std::vector<Car> parked;
  std::vector<Pond> ponds;
};

constexpr float kRoadHalfWidth = 4.4F;
constexpr float kPavementWidth = 2.2F;

enum class GroundKind { kRoad, kPavement, kPad, kCell, kField };

// What the ground is at a point.
struct GroundSample {
  GroundKind kind = GroundKind::kField;
  float across = 0.0F;       // roads: signed distance to the centre line of the nearer street
  float along = 0.0F;        // roads: coordinate along it
  float to_crossing = 0.0F;  // roads: distance along it to the centre of the nearest crossing; 1e6 when there is none
  bool crossing = false;
  int street = 0;
  const Cell* cell = nullptr;
  const PavedArea* pad = nullptr;
};

class CityLayout {
 public:
  CityLayout(const CityPlan& plan, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max, uint32_t seed);

  GroundSample Sample(float east, float north) const;
  const CityContents& contents() const { return contents_; }
  CityContents& contents() { return contents_; }
  // `count` cars at random positions on lanes of the streets that cross the rectangle.
  std::vector<MovingCar> MakeMovingCars(int count, const Eigen::Vector2d& min, const Eigen::Vector2d& max, base::Random& random) const;

 private:
  void ChooseKinds(const CityPlan& plan, base::Random& random);
  void AddStreetLife(const CityPlan& plan, base::Random& random);
  void AddFieldTrees(const CityPlan& plan, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max, base::Random& random);

  float pitch_ = 66.0F;
  Eigen::Vector2f phase_ = Eigen::Vector2f::Zero();
  int first_x_ = 0, last_x_ = 0, first_y_ = 0, last_y_ = 0;  // indices of the streets
  int columns_ = 0, rows_ = 0;                               // cells between them
  std::vector<Cell> cells_;                                  // row by row from the south-west
  CityContents contents_;
};

// Fills one cell with buildings, trees, cars and pads. Buildings do not overlap each other, and trees do not overlap buildings.
void FurnishCell(const CityPlan& plan, Cell& cell, CityContents& contents, base::Random& random);
// False when the crown would touch a building or the tree would be in a pond. Only buildings from index `first_building` on are checked.
bool TreeFits(const Tree& tree, const CityContents& contents, size_t first_building);

}  // namespace skyquilt::simulate
