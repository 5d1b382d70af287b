// Writes what OpenDroneMap's stage odm_report writes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/stages/pipeline.h"
#include "core/survey/survey.h"
#include "odm/dataset.h"
#include "odm/map_options.h"

namespace skyquilt::odm {

// cameras.json and images.json in the dataset's folder; in odm_report/ shots.geojson, ground_control_points.geojson (also in odm_georeferencing/,
// where WebODM looks), stats.json, and with a report index.html with its pictures, metrics.json and report.pdf. Needs a survey; what comes of later
// stages is left out where it is missing. seconds: of all stages so far. Throws base::InputError, base::Interrupted.
void WriteReports(const coordinator::Pipeline& pipeline, const Dataset& dataset, const Wishes& wishes, double seconds);

// Warnings that must be among the last lines of the output, of which NodeODM's page shows nine: photos that are not used, no place on Earth.
std::vector<std::string> ClosingWarnings(const survey::Survey& survey);

}  // namespace skyquilt::odm
