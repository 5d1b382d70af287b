// The report's section on buildings and its parts; HTML. Texts are escaped here.
#pragma once

#include <string>

#include "buildings/building.h"
#include "evaluate/buildings/buildings_report.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

// The found buildings, and their scores. Empty when none were searched.
std::string BuildingsSection(const ReportInput& input);

// Footprints coloured by height, north up; outlines that were missed and buildings that were invented are marked when the truth is known.
std::string BuildingsMap(const ReportInput& input);
std::string BuildingsTable(const buildings::BuildingsReport& report);
std::string BuildingCards(const buildings::BuildingsReport& report);
// Figures against the truth; empty without.
std::string BuildingScoreTables(const buildings::BuildingScores& scores);
// The footprint along its axes with the lengths of its walls and the lines of its roof, as SVG.
std::string BuildingPlan(const buildings::Building& building, const buildings::BuildingSet& set);

}  // namespace skyquilt::evaluate::page
