// Errors of the measures, roof kinds and corners of matched buildings.
#pragma once

#include <span>
#include <vector>

#include "evaluate/buildings/building_scores.h"
#include "evaluate/buildings/match_buildings.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::buildings {

// One measure of one matched building: found minus true, and the uncertainty that was claimed; NaN: not known.
struct MeasureError {
  double error = 0.0;
  double sigma = kNotMeasured;
};
// Errors that are not finite do not count.
BuildingErrors SummariseErrors(const char* measure, std::span<const MeasureError> errors);
// Difference of two directions of an axis in degrees, modulo 180, or modulo 90 for a building that is nearly square: which of its sides is longer is
// then chance.
double YawError(double found_deg, double true_deg, bool nearly_square);

// All, then by true kind of roof; kinds that no matched building has are left out. Eave and ridge: of pitched roofs, deck: of flat ones.
std::vector<BuildingRoofScores> ScoreMeasures(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches);

// One per outline that counts and per invented building, for figures over several surveys.
std::vector<BuildingOutcome> ListOutcomes(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches);

// The corners of true outlines, where walls meet at an angle, against the nearest corner that was found of the same building. Those farther than 3 m
// from any do not count in the RMSE (as in Rottensteiner et al. 2014, the ISPRS benchmark).
void ScoreCorners(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches, BuildingTruthScores* scores);

}  // namespace skyquilt::evaluate::buildings
