// Tables, sentences and pictures of the comparison of lights.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/study.h"

namespace skyquilt::bench {

// The trainings of one set of lights. Of any the failure may be set, or no light measured.
struct LightSet {
  std::vector<std::string> lights;         // folders, in order
  VariantResult every_second, all, plain;  // codes of every second light, of all, and none
  VariantResult corrected;                 // no codes, but brightness correction; only of intensities
};

// The number in a light's folder: "sun_05" is 5.
double LightValue(const std::string& folder);
// Null when it was not measured.
const LightScore* FindScore(const VariantResult& result, const std::string& light, const std::string& look);
// Mean over the lights between of a member of their scores in a look; NaN when one is missing.
double MeanBetween(const LightSet& set, const VariantResult& result, const std::string& look, double LightScore::*member);
// How mixed codes show shadows between the trained lights: 0 as a cross-fade of the renderings with both codes, 1 as the light's own code does. NaN
// when that shows too little of their movement to tell.
double MovementOfShadows(const LightSet& set);

// One row per light. unit: of the light's number.
BenchTable LightTable(const LightSet& set, const std::string& name, const std::string& unit);
// One row per light between: what its shadows do.
BenchTable MovedTable(const LightSet& set, const std::string& name);
// PSNR over the lights.
std::string LightChart(const LightSet& set, const std::string& title, const std::string& x_label);
// Whether shadows fade or move between the lights, in a sentence; and what the numbers are.
std::vector<std::string> SunVerdicts(const LightSet& set);
// How much of the stops between intensities the correction found, and what codes do.
std::vector<std::string> IntensityVerdicts(const LightSet& set);
// Rows of pictures: photos of three neighbouring lights, then the renderings; and FOLDER/light.png with all. Nothing when pictures are gone.
BenchSection WriteLightPictures(const LightSet& set, const std::filesystem::path& folder);

}  // namespace skyquilt::bench
