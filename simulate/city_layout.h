// Plan of a simulated city: a grid of streets, the cells between them, and the contents of each cell. East and north only; heights are added later,
// from the terrain. Streets and cells are laid out along the axes of the city, x and y, whose origin is that of ENU. The city is then turned about
// the middle of the ground: contents and everything that CityLayout takes and gives are in ENU. The contents of cells in one half of the city, the
// second district, are turned a little further, each about the middle of its cell.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/random.h"
#include "simulate/bridge.h"
#include "simulate/car.h"
#include "simulate/person.h"
#include "simulate/place_spec.h"
#include "simulate/plane_turn.h"
#include "simulate/simulated_building.h"
#include "simulate/tree.h"

namespace skyquilt::simulate {

enum class CellKind { kHouses, kFlats, kTowers, kPark, kField, kWood };
enum class PadKind { kDriveway, kPath, kParking, kTerrace, kPlaza };

// A paved rectangle on the ground, along the axes of the city.
struct PavedArea {
  PadKind kind = PadKind::kPath;
  Eigen::Vector2f centre = Eigen::Vector2f::Zero();
  Eigen::Vector2f half = Eigen::Vector2f::Ones();  // half sizes along its own axes
  float cosine = 1.0F;                             // of its yaw
  float sine = 0.0F;
  Eigen::Vector2f Local(float x_in_city, float y_in_city) const {
    const float x = x_in_city - centre.x();
    const float y = y_in_city - centre.y();
    return {cosine * x + sine * y, cosine * y - sine * x};
  }
};

struct Cell {
  CellKind kind = CellKind::kHouses;
  Eigen::Vector2d min = Eigen::Vector2d::Zero();  // inside the pavements, along the axes of the city, metres
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  std::vector<PavedArea> pads;
  PlaneTurn turn;             // of the contents
  double lots_begin_m = 0.0;  // x of the first garden, before the turn
  float lot_pitch_m = 1e6F;   // width of a garden along x
  double landmark_m = 0.0;    // height of the one tower of this cell; 0: it is like the others of its kind
  bool showcase = false;      // of varied towns: this cell has all shapes that cells of its kind can have
  double to_street_m = 0.0;   // paths and drives are longer by this, because a turned plot does not reach the street everywhere
};

struct Pond {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d radii = Eigen::Vector2d::Ones();  // along `axis` and across it
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();
  double level_z_m = 0.0;
  // Relative distance from the centre: 0 at the centre, 1 at the shore.
  double Radius(double east, double north) const {
    const Eigen::Vector2d d(east - centre.x(), north - centre.y());
    return std::hypot((axis.x() * d.x() + axis.y() * d.y()) / radii.x(), (axis.x() * d.y() - axis.y() * d.x()) / radii.y());
  }
  // A point this many radii along the axis and across it from the centre.
  Eigen::Vector2d At(double along, double across) const {
    return centre + along * radii.x() * axis + across * radii.y() * Eigen::Vector2d(-axis.y(), axis.x());
  }
};

struct CityContents {
  std::vector<Building> buildings;
  std::vector<Tree> trees;
  std::vector<Car> parked;
  std::vector<Lamp> lamps;
  std::vector<Pond> ponds;
  std::optional<Bridge> bridge;
};

constexpr float kRoadHalfWidth = 4.4F;
constexpr float kPavementWidth = 2.2F;

enum class GroundKind { kRoad, kPavement, kPad, kCell, kField };

// What the ground is at a point.
struct GroundSample {
  GroundKind kind = GroundKind::kField;
  Eigen::Vector2f city = Eigen::Vector2f::Zero();  // the point along the axes of the city
  float across = 0.0F;                             // roads: signed distance to the centre line of the nearer street
  float along = 0.0F;                              // roads: coordinate along it
  float to_crossing = 0.0F;                        // roads: distance along it to the centre of the nearest crossing; 1e6 when there is none
  bool crossing = false;
  int street = 0;
  const Cell* cell = nullptr;
  const PavedArea* pad = nullptr;
};

class CityLayout {
 public:
  // ground_min, ground_max: the modelled ground, ENU. Nothing stands beyond it.
  CityLayout(const CityPlan& plan, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max, uint32_t seed);

  GroundSample Sample(float east, float north) const;
  const CityContents& contents() const { return contents_; }
  CityContents& contents() { return contents_; }
  // Centre lines of the streets that cross the rectangle, from one of its edges to another: both ends, ENU metres.
  std::vector<std::array<Eigen::Vector2d, 2>> StreetsAcross(const Eigen::Vector2d& min, const Eigen::Vector2d& max) const;
  // `count` cars at random positions on lanes of the streets that cross the rectangle, each from one of its edges to another.
  std::vector<MovingCar> MakeMovingCars(int count, const Eigen::Vector2d& min, const Eigen::Vector2d& max, base::Random& random) const;
  // `count` people at random places on the pavements of these streets.
  std::vector<Walker> MakeWalkers(int count, const Eigen::Vector2d& min, const Eigen::Vector2d& max, base::Random& random) const;

 private:
  // A street's centre line inside a rectangle.
  struct Lane {
    double line = 0.0;  // coordinate of the centre line across the street, in the city
    double from = 0.0;  // coordinates along it, in the city
    double to = 0.0;
  };

  void AddCells(const CityPlan& plan);
  void ChooseKinds(const CityPlan& plan, base::Random& random);
  // by_distance: indices of the cells, those nearest to the middle of the city first.
  void ChooseSpecialCells(const CityPlan& plan, const std::vector<size_t>& by_distance, base::Random& random);
  // Cells without buildings, of those that would have some.
  void ChooseWoods(const CityPlan& plan, uint32_t seed);
  void FurnishCells(const CityPlan& plan, uint32_t seed);
  void AddStreetLife(const CityPlan& plan, base::Random& random);
  // Turns the contents with the city, and removes what is beyond the ground.
  void TurnContents(const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max);
  // Beside some houses of varied towns, on ground that is not paved.
  void AddWallTrees(const CityPlan& plan, uint32_t seed);
  // Over the crossing nearest to the middle; what is in its way is removed.
  void AddBridge(base::Random& random);
  // At kerbs, up to plan.trucks, where there is room. Parked cars in their way are removed.
  void AddTrucks(const CityPlan& plan, base::Random& random);
  // At kerbs of the streets of the built-up rectangle, up to plan.lamps, where there is room.
  void AddLamps(const CityPlan& plan, base::Random& random);
  std::vector<Lane> LanesAcross(int axis, const Eigen::Vector2d& min, const Eigen::Vector2d& max) const;
  void AddFieldTrees(const CityPlan& plan, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max, base::Random& random);

  PlaneTurn turn_;
  float pitch_ = 66.0F;
  Eigen::Vector2f phase_ = Eigen::Vector2f::Zero();
  int first_x_ = 0, last_x_ = 0, first_y_ = 0, last_y_ = 0;  // indices of the streets
  int columns_ = 0, rows_ = 0;                               // cells between them
  std::vector<Cell> cells_;                                  // row by row from the south-west
  CityContents contents_;
};

// Fills one cell with buildings, trees, cars and pads, along the axes of the city. Buildings do not overlap each other, except parts of one outline,
// and trees do not overlap buildings. Houses, flats and towers are turned by turn_deg about the middle of the cell; houses fill a smaller square
// then, so that they fit. Flats and towers that would reach into the street are not turned.
void FurnishCell(const CityPlan& plan, double turn_deg, Cell& cell, CityContents& contents, base::Random& random);
// Turns everything in `contents`.
void TurnAll(const PlaneTurn& turn, CityContents& contents);
// False when the crown would touch a building or the tree would be in a pond. Only buildings from index `first_building` on are checked.
bool TreeFits(const Tree& tree, const CityContents& contents, size_t first_building);

}  // namespace skyquilt::simulate
