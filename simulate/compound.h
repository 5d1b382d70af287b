// Buildings of several parts: wings, set-backs, rows and courtyards. Each is made about the origin, the middle of the rectangle around its walls,
// with its length along x; MoveParts puts it in its place. The first part is the main one.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "simulate/plane_turn.h"
#include "simulate/simulated_building.h"

namespace skyquilt::simulate {

// Turns the parts about the origin, then moves it to `place`.
void MoveParts(const PlaneTurn& turn, const Eigen::Vector2d& place, std::vector<Building>& parts);

// Sizes of the rectangle around parts whose sides are along x and y.
Eigen::Vector2d SizeAround(std::span<const Building> parts);

struct Wing {
  double along_m = 0.0;   // its middle, along the main part's length axis
  double width_m = 4.5;   // along the main part's wall
  double length_m = 5.0;  // away from it, at least width_m
  double eave_height_m = 3.0;
};
// A wing at the +y side of `main`, with a roof of the same kind and rise: a gable that runs into the main roof, or a lower deck. The ridge must be
// lower than the main part's.
std::vector<Building> WithWing(const Building& main, const Wing& wing, BuildingShape shape);

// A flat part of these sizes on the deck of another, `offset` from its middle, both along x and y. height_m: of its deck above the ground.
std::vector<Building> WithSetback(const Building& podium, const Eigen::Vector2d& size, const Eigen::Vector2d& offset, double height_m);

// Houses side by side along x, from -x, their front walls (-y) in one line.
std::vector<Building> Row(std::vector<Building> houses);

// Four flat wings around a court: front, right, back and left, with these decks. size: of the rectangle around them, the longer side along x. Every
// wing is depth_m deep; the left and right ones stand between the others and are longer than deep when size.y() >= 3 depth_m.
std::vector<Building> Courtyard(const Building& like, const Eigen::Vector2d& size, double depth_m, const std::array<double, 4>& heights_m);

}  // namespace skyquilt::simulate
