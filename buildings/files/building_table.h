// What is known of each building as a table: the columns of buildings.csv, which are the fields of buildings.gpkg too.
#pragma once

#include <string>
#include <vector>

#include "buildings/building.h"
#include "buildings/files/file_frame.h"
#include "core/gis/vector_layers.h"

namespace skyquilt::buildings {

struct NamedMeasure {
  std::string name;  // with its unit; without one for lengths, areas and volumes of unknown scale
  Measure measure;   // heights in the height system of the maps; rounded to 0.1 mm and the like
};
// In the order of the CSV. The ground has the height that the geo-reference gives it; other heights stand above it as high as they were measured.
std::vector<NamedMeasure> MeasuresOf(const Building& building, const FileFrame& frame);

struct BuildingTable {
  std::vector<gis::LayerField> fields;
  std::vector<std::vector<gis::FieldValue>> rows;  // one per building
};
BuildingTable TableOf(const BuildingSet& set, const FileFrame& frame);

}  // namespace skyquilt::buildings
