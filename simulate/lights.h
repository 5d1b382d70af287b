// The lights under which all photos of a survey are taken again (simulate.lights): the same places, poses and settings of the camera, so that only
// the light tells the photos of one place apart.
#pragma once

#include <string>
#include <vector>

#include "simulate/flight.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {

struct Light {
  std::string folder;              // of its photos below images/; empty: images/ itself
  double sun_elevation_deg = 0.0;  // above the horizon
  double intensity = 1.0;          // factor on the light of sun and sky
};

// By rising elevation or intensity, whose numbers are in the folders with as many digits each. For "one" the light of place and options.
std::vector<Light> PlanLights(const SimulateOptions& options, const PlaceSpec& place);

// All photos under the first light, then all under the second ...; with one light nothing changes. The rest of a flight after a multiple of
// `test_every` photos is left out, so that every n-th photo in name order is of the same places in every light; a flight shorter than that stays
// whole. Sparse points are sought under the first light only. Times go on from one light to the next.
void RepeatUnder(const std::vector<Light>& lights, int test_every, std::vector<PhotoPlan>& photos);

}  // namespace skyquilt::simulate
