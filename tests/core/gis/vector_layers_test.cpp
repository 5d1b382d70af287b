#include "core/gis/vector_layers.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <limits>
#include <memory>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/limited_file_size.h"

namespace skyquilt::gis {
namespace {

using VectorLayers = InTemporaryFolder;

const geo::UtmZone kMapZone = {32, true};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using OpenDataset = std::unique_ptr<GDALDataset, CloseDataset>;

OpenDataset OpenVectors(const std::filesystem::path& file) {
  GDALAllRegister();
  return OpenDataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR));
}

// A square with a square hole, its corners at rising heights.
LayerPolygon Yard(double x, double y) {
  return {{{x, y, 1.0}, {x + 20.0, y, 2.0}, {x + 20.0, y + 10.0, 3.0}, {x, y + 10.0, 4.0}},
          {{x + 5.0, y + 2.0, 5.0}, {x + 5.0, y + 8.0, 6.0}, {x + 9.0, y + 8.0, 7.0}, {x + 9.0, y + 2.0, 8.0}}};
}

std::vector<VectorLayer> TwoLayers() {
  std::vector<VectorLayer> layers(2);
  layers[0] = {.name = "plans",
               .description = "seen from above",
               .geometry = LayerGeometry::kPolygon,
               .fields = {{"number", FieldType::kInteger}, {"size_m", FieldType::kReal}, {"text", FieldType::kText}},
               .features = {}};
  layers[0].features.push_back({{Yard(572000.0, 5361000.0)}, {int64_t{1} << 40U, 0.1, std::string("ü \"quoted\" ⌂")}});
  layers[0].features.push_back({{}, {std::monostate(), std::numeric_limits<double>::quiet_NaN(), std::string()}});
  layers[1] = {
      .name = "bodies", .description = "", .geometry = LayerGeometry::kMultiPolygonZ, .fields = {{"size_m", FieldType::kReal}}, .features = {}};
  layers[1].features.push_back({{Yard(572000.0, 5361000.0), Yard(572100.0, 5361000.0)}, {2.5}});
  return layers;
}

TEST_F(VectorLayers, ComeBackThroughGdal) {
  WriteVectorLayers(TwoLayers(), true, kMapZone, folder_ / "two.gpkg");
  const OpenDataset file = OpenVectors(folder_ / "two.gpkg");
  ASSERT_NE(file, nullptr);
  ASSERT_EQ(file->GetLayerCount(), 2);
  OGRLayer* plans = file->GetLayer(0);
  EXPECT_STREQ(plans->GetName(), "plans");
  EXPECT_STREQ(plans->GetMetadataItem("DESCRIPTION"), "seen from above");
  EXPECT_STREQ(plans->GetSpatialRef()->GetAuthorityCode(nullptr), "32632");
  EXPECT_EQ(plans->GetGeomType(), wkbPolygon);
  ASSERT_EQ(plans->GetFeatureCount(), 2);
  const OGRFeatureUniquePtr yard(plans->GetNextFeature());
  EXPECT_EQ(yard->GetFieldAsInteger64("number"), int64_t{1} << 40U);
  EXPECT_EQ(yard->GetFieldAsDouble("size_m"), 0.1);
  EXPECT_STREQ(yard->GetFieldAsString("text"), "ü \"quoted\" ⌂");
  const OGRPolygon* polygon = yard->GetGeometryRef()->toPolygon();
  EXPECT_EQ(polygon->getNumInteriorRings(), 1);
  EXPECT_NEAR(polygon->get_Area(), 200.0 - 24.0, 1e-6);
  EXPECT_FALSE(polygon->Is3D());
  const OGRFeatureUniquePtr nowhere(plans->GetNextFeature());
  EXPECT_EQ(nowhere->GetGeometryRef(), nullptr);
  EXPECT_TRUE(nowhere->IsFieldNull(nowhere->GetFieldIndex("number")));
  EXPECT_TRUE(nowhere->IsFieldNull(nowhere->GetFieldIndex("size_m"))) << "not finite";
  EXPECT_TRUE(nowhere->IsFieldSetAndNotNull(nowhere->GetFieldIndex("text")));

  OGRLayer* bodies = file->GetLayer(1);
  EXPECT_EQ(bodies->GetGeomType(), wkbMultiPolygon25D);
  const OGRFeatureUniquePtr body(bodies->GetNextFeature());
  const OGRMultiPolygon* all = body->GetGeometryRef()->toMultiPolygon();
  ASSERT_EQ(all->getNumGeometries(), 2);
  const OGRLinearRing* ring = all->getGeometryRef(1)->getExteriorRing();
  ASSERT_EQ(ring->getNumPoints(), 5);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(ring->getZ(i), 1.0 + i % 4);
  EXPECT_EQ(ring->getX(1), 572120.0);
}

TEST_F(VectorLayers, WithoutGeoreferenceHaveNoPlaceOnEarth) {
  WriteVectorLayers(TwoLayers(), false, {}, folder_ / "local.gpkg");
  const OpenDataset file = OpenVectors(folder_ / "local.gpkg");
  for (OGRLayer* layer : file->GetLayers()) EXPECT_TRUE(layer->GetSpatialRef() == nullptr || layer->GetSpatialRef()->IsLocal());
}

TEST_F(VectorLayers, TheSameLayersGiveTheSameBytes) {
  WriteVectorLayers(TwoLayers(), true, kMapZone, folder_ / "a.gpkg");
  // Longer than the resolution of the time stamps.
  timespec wait = {.tv_sec = 0, .tv_nsec = 20'000'000};
  nanosleep(&wait, nullptr);
  WriteVectorLayers(TwoLayers(), true, kMapZone, folder_ / "b.gpkg");
  WriteVectorLayers(TwoLayers(), true, kMapZone, folder_ / "b.gpkg");
  EXPECT_TRUE(base::ReadFile(folder_ / "a.gpkg") == base::ReadFile(folder_ / "b.gpkg"));
}

TEST_F(VectorLayers, FailuresLeaveTheEarlierFile) {
  base::WriteFileAtomically(folder_ / "two.gpkg", "earlier");
  const std::string missing = InputErrorOf([&] { WriteVectorLayers(TwoLayers(), true, kMapZone, folder_ / "no_such_folder/two.gpkg"); });
  EXPECT_NE(missing.find("two.gpkg: cannot be created"), std::string::npos) << missing;
  {
    const LimitedFileSize full(60'000);
    const std::string error = InputErrorOf([&] { WriteVectorLayers(TwoLayers(), true, kMapZone, folder_ / "two.gpkg"); });
    EXPECT_NE(error.find("Check the free space"), std::string::npos) << error;
  }
  ExpectStopsWhenAsked([&] { WriteVectorLayers(TwoLayers(), true, kMapZone, folder_ / "two.gpkg"); });
  EXPECT_EQ(base::ReadFile(folder_ / "two.gpkg"), "earlier");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(VectorLayers, RefuseWhatDoesNotFit) {
  const auto refuses = [&](const auto& change) {
    std::vector<VectorLayer> layers = TwoLayers();
    change(&layers);
    try {
      WriteVectorLayers(layers, true, kMapZone, folder_ / "bad.gpkg");
    } catch (const std::logic_error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refuses([](auto*) {}));
  EXPECT_TRUE(refuses([](auto* layers) { layers->at(0).features[0].values.pop_back(); }));
  EXPECT_TRUE(refuses([](auto* layers) { layers->at(0).features[0].values[0] = 1.0; })) << "a real number in a field of integers";
  EXPECT_TRUE(refuses([](auto* layers) { layers->at(0).features[0].polygons.push_back(Yard(0, 0)); }));
  EXPECT_TRUE(refuses([](auto* layers) { layers->at(1).features[0].polygons[0][1].resize(2); }));
  EXPECT_TRUE(refuses([](auto* layers) { layers->at(1).features[0].polygons[0][0][0].z() = std::numeric_limits<double>::infinity(); }));
}

}  // namespace
}  // namespace skyquilt::gis
