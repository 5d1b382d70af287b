// The tables that control points, marks and positions of photos are read from, the meaning of their columns, and names of photos.
#include "prepare/control/reading/control_columns.h"
#include "prepare/models/photo_names.h"
#include "prepare/tables/text_table.h"
#include "tests/fuzz/fuzz_target.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  return {"EPSG:4326\nDJI_0028.JPG -91.99 46.84 198.6\n\"my photo.jpg\" -91.98 46.85\n",
          "\xEF\xBB\xBF\"EPSG:4326\",,,\r\nphoto,lat,lon,height\r\n\"a, \"\"b\"\".jpg\",46.84,-91.99,NaN\r\n",
          "#CoordinateSystem: EPSG:32632\n#Label;X/Easting;Y/Northing;Z/Altitude\nA;586000,5;4507000,25;3\n",
          "a b.jpg\t8,4\t47,1\t\t0,02\nc.jpg\t8,5\t47,2\t400\t0,02\n",
          "A\t\t586000 4507000\t3\n",
          "a.jpg 8,4 47,1\nb.jpg 8,5 47,2\n"};
}

void Feed(const std::string& bytes) {
  try {
    const prepare::tables::TextTable table = prepare::tables::ParseTextTable("table.txt", bytes);
    const prepare::models::PhotoNames names({"a.jpg", "x/DJI_0028.JPG", "y/DJI_0028.JPG", "a b.jpg"});
    for (const prepare::control::TableKind kind :
         {prepare::control::TableKind::kPoints, prepare::control::TableKind::kMarks, prepare::control::TableKind::kPositions}) {
      const prepare::control::ControlColumns columns(table.heading, kind);
      for (const prepare::tables::TableRow& row : table.rows) columns.Field(row.fields, prepare::control::ControlColumn::kX);
    }
    for (const prepare::tables::TableRow& row : table.rows) {
      for (const std::string& field : row.fields) {
        prepare::tables::ParseTableNumber(field, table.decimal_comma);
        if (const auto found = names.Find(field)) names.CommonParts(field, *found);
      }
    }
  } catch (const base::InputError&) {
  }
}

}  // namespace skyquilt::fuzz
