#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <memory>

#include "buildings/files/building_files.h"
#include "tests/buildings/files/sample_set.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::buildings {
namespace {

using BuildingsPackage = InTemporaryFolder;

struct Close {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Opened = std::unique_ptr<GDALDataset, Close>;

Opened WrittenPackage(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file) {
  WriteGeoPackage(set, frame, file);
  GDALAllRegister();
  return Opened(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR));
}

TEST_F(BuildingsPackage, HoldsFootprintsWithTheirHoles) {
  const BuildingSet set = SampleSet();
  const surface::MapFrame frame = SampleFrame();
  const Opened file = WrittenPackage(set, frame, folder_ / "buildings.gpkg");
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(file->GetLayerCount(), 2);
  OGRLayer* layer = file->GetLayerByName("footprints");
  ASSERT_NE(layer, nullptr);
  EXPECT_STREQ(layer->GetSpatialRef()->GetAuthorityCode(nullptr), "32632");
  EXPECT_EQ(layer->GetGeomType(), wkbPolygon);
  ASSERT_EQ(layer->GetFeatureCount(), static_cast<GIntBig>(set.buildings.size()));
  size_t next = 0;
  for (const auto& feature : *layer) {
    const Building& building = set.buildings[next++];
    EXPECT_EQ(feature->GetFieldAsInteger64("id"), building.id);
    const OGRPolygon* polygon = feature->GetGeometryRef()->toPolygon();
    EXPECT_EQ(polygon->getNumInteriorRings(), static_cast<int>(building.footprint.holes.size()));
    EXPECT_NEAR(polygon->get_Area(), Area(building.footprint), 1e-3 * Area(building.footprint));
    OGRPoint middle;
    polygon->Centroid(&middle);
    const Eigen::Vector2d place = Centroid(building.footprint);
    EXPECT_NEAR(middle.getX(), frame.MapFromEnu({place.x(), place.y(), 0.0}).x(), 0.01);
    EXPECT_NEAR(feature->GetFieldAsDouble("length_m"), building.measures.length_m.value, 1e-4);
    EXPECT_EQ(feature->IsFieldSetAndNotNull(feature->GetFieldIndex("pitch_deg")) != 0, building.id != 4);
    EXPECT_EQ(std::string(feature->GetFieldAsString("note")), building.note);
    EXPECT_EQ(std::string(feature->GetFieldAsString("roof")), NameOf(building.roof));
  }
  EXPECT_NE(std::string(layer->GetMetadataItem("DESCRIPTION")).find("EPSG:32632"), std::string::npos);
}

TEST_F(BuildingsPackage, HoldsSolidsInSpace) {
  const BuildingSet set = SampleSet();
  const surface::MapFrame frame = SampleFrame();
  const Opened file = WrittenPackage(set, frame, folder_ / "buildings.gpkg");
  OGRLayer* layer = file->GetLayerByName("solids");
  ASSERT_NE(layer, nullptr);
  EXPECT_EQ(layer->GetGeomType(), wkbMultiPolygon25D);
  size_t next = 0;
  for (const auto& feature : *layer) {
    const Solid& solid = set.buildings[next++].lod22;
    const OGRMultiPolygon* faces = feature->GetGeometryRef()->toMultiPolygon();
    ASSERT_EQ(faces->getNumGeometries(), static_cast<int>(solid.face.size()));
    for (int f = 0; f < faces->getNumGeometries(); ++f) {
      const OGRLinearRing* ring = faces->getGeometryRef(f)->getExteriorRing();
      const std::vector<uint32_t>& outer = solid.face[static_cast<size_t>(f)].outer;
      ASSERT_EQ(ring->getNumPoints(), static_cast<int>(outer.size()) + 1);
      for (int i = 0; i < ring->getNumPoints(); ++i) {
        const Eigen::Vector3d expected = frame.MapFromEnu(solid.vertex[outer[static_cast<size_t>(i) % outer.size()]]);
        EXPECT_NEAR(ring->getX(i), expected.x(), 1e-4);
        EXPECT_NEAR(ring->getY(i), expected.y(), 1e-4);
        EXPECT_NEAR(ring->getZ(i), expected.z(), 1e-4);
      }
    }
  }
  EXPECT_EQ(next, set.buildings.size());
}

TEST_F(BuildingsPackage, WithoutGeoreferenceIsLocal) {
  BuildingSet set = SampleSet();
  set.metric = false;
  const Opened file = WrittenPackage(set, SampleFrame(false), folder_ / "buildings.gpkg");
  OGRLayer* layer = file->GetLayerByName("footprints");
  EXPECT_TRUE(layer->GetSpatialRef() == nullptr || layer->GetSpatialRef()->IsLocal());
  EXPECT_GE(layer->GetLayerDefn()->GetFieldIndex("length"), 0);
  EXPECT_LT(layer->GetLayerDefn()->GetFieldIndex("length_m"), 0);
  const Opened empty = WrittenPackage({}, SampleFrame(), folder_ / "none.gpkg");
  EXPECT_EQ(empty->GetLayerByName("solids")->GetFeatureCount(), 0);
}

}  // namespace
}  // namespace skyquilt::buildings
