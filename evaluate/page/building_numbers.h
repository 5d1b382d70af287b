// Numbers of buildings with units and uncertainties, as HTML.
#pragma once

#include <string>

#include "buildings/building.h"

namespace skyquilt::evaluate::page {

// Empty without a known scale: a unit would claim a length.
struct BuildingUnits {
  const char* length = "m";
  const char* area = "m\xC2\xB2";
  const char* volume = "m\xC2\xB3";

  static BuildingUnits Of(const skyquilt::buildings::BuildingSet& set);
};

// "8.53 ± 0.12 m": one standard deviation with two digits, and the value to match; two decimals without an uncertainty; an en dash without a value.
std::string ShownMeasure(const skyquilt::buildings::Measure& measure, const char* unit);
// A right-aligned table cell with it.
std::string MeasureCell(const skyquilt::buildings::Measure& measure, const char* unit);

}  // namespace skyquilt::evaluate::page
