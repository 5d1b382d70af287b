// The geo-reference part of survey.json. Numbers that are NaN are stored as null.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/survey/geo_fit.h"

namespace skyquilt::survey {

nlohmann::ordered_json NumberOrNull(double value);
double NanIfNull(const nlohmann::json& value);

nlohmann::ordered_json ToJson(const geo::PlaceAccuracy& accuracy);
nlohmann::ordered_json ToJson(const GeoFit& fit);
nlohmann::ordered_json ToJson(const FlightChecks& checks);
nlohmann::ordered_json ToJson(const Problem& problem);

// Throw nlohmann::json::exception for missing keys and wrong types.
geo::PlaceAccuracy PlaceAccuracyFromJson(const nlohmann::json& value);
GeoFit GeoFitFromJson(const nlohmann::json& value);
FlightChecks FlightChecksFromJson(const nlohmann::json& value);
Problem ProblemFromJson(const nlohmann::json& value);

}  // namespace skyquilt::survey
