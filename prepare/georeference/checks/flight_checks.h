// Looks for what a flight may do to its reconstruction and no geo-reference can repair: smear by a rolling shutter, doming, an ill-determined lens.
#pragma once

#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

// Index into Survey::cameras of the camera with most photos, the first of several; -1 without photos.
int MainCamera(const survey::Survey& survey);

// Fills in all but k1_sigma, which needs the 2-D observations (prepare/bundle/intrinsics_sigma.h). `photos`: of the survey, in its order.
// Photos must have their AGL and GPS corrections. The speed is the median of the speed tags; without any, that between photos, which is too high for
// a drone that stops for each. Lengths are known only in geo-referenced surveys: in others all that needs metres stays NaN.
survey::FlightChecks CheckFlight(const survey::Survey& survey, const std::vector<input::PreparedPhoto>& photos);

// What the checks found, the worst first: rolling_shutter (smear above kMaxSmear_px), doming (above 3 sigma, 1 m and 1 % of the height above ground),
// lens_uncertain (one sigma of k1 moves the image corner by more than kMaxCornerShift_px).
std::vector<survey::Problem> FlightProblems(const survey::FlightChecks& checks, const survey::Survey& survey);

// Displacement in pixels of the image corner farthest from the principal point when k1 changes by `change`; NaN for cameras without k1.
double CornerShift(const camera::Camera& camera, double change);

// One line for the log, with "unknown" for what is not known.
std::string DescribeChecks(const survey::FlightChecks& checks);

constexpr double kMaxSmear_px = 1.0;
constexpr double kMaxCornerShift_px = 1.0;

}  // namespace skyquilt::prepare::georeference
