#include "evaluate/surface/surface_json.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "evaluate/metrics/metrics.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::surface {
namespace {

SurfaceScores SomeScores() {
  SurfaceScores scores;
  scores.psnr = 25.5;
  scores.psnr_field = 26.25;
  scores.pixels = 1234;
  scores.missing_share = 0.015625;
  scores.deck_samples = 77;
  scores.decks_within_2_gsd = 0.96875;
  scores.agreement = {.mesh_samples = 100, .true_samples = 200, .accuracy_median_m = 0.0625};
  scores.agreement.completeness_median_m = std::numeric_limits<double>::infinity();
  scores.agreement.f_scores = {{"2 GSD", 0.125, 0.5, 1.0, 0.75}, {"5 cm", 0.05}};
  scores.classes = {{.name = "roof", .pixels = 10, .missing_pixels = 1, .psnr_db = 24.0}, {.name = "tree"}};
  scores.classes[0].agreement = scores.agreement;
  scores.record.triangles = 335120;
  scores.record.non_manifold_edges = 0;
  scores.record.voxel_m = 0.09375;
  scores.record.files = {{"mesh.glb", "textured mesh", "GLB", "EPSG:32617 minus offset", "WGS84 ellipsoid", 1234567, "335,120 triangles"}};
  return scores;
}

TEST(SurfaceJson, IsPartOfTheMetricsAndReadBack) {
  metrics::Metrics metrics;
  EXPECT_FALSE(base::ParseJson(metrics::MetricsJson(metrics)).contains("surface"));
  metrics.surface = SomeScores();
  const std::string text = metrics::MetricsJson(metrics);
  const auto json = base::ParseJson(text).at("surface");
  EXPECT_EQ(json["psnr"], 25.5);
  EXPECT_EQ(json["missing_share"], 0.015625);
  EXPECT_TRUE(json["psnr_where_mesh"].is_null());
  EXPECT_EQ(json["f_scores"][0]["tau"], "2 GSD");
  EXPECT_EQ(json["f_scores"][0]["tau_m"], 0.125);
  EXPECT_EQ(json["f_scores"][0]["recall"], 1.0);
  EXPECT_TRUE(json["f_scores"][1]["f"].is_null());
  EXPECT_TRUE(json["completeness_median_m"].is_null());  // infinite
  EXPECT_EQ(json["classes"]["roof"]["f_scores"][0]["f"], 0.75);
  EXPECT_EQ(json["decks_within_2_gsd"], 0.96875);
  EXPECT_EQ(json["non_manifold_edges"], 0);
  EXPECT_TRUE(json["boundary_edges"].is_null());
  EXPECT_EQ(json["files"][0]["bytes"], 1234567);

  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "metrics.json", text);
  const metrics::Metrics back = metrics::ReadMetrics(folder / "metrics.json");
  ASSERT_TRUE(back.surface.has_value());
  EXPECT_EQ(metrics::MetricsJson(back), text);
  EXPECT_EQ(back.surface->record.boundary_edges, -1);
  EXPECT_EQ(back.surface->classes[0].agreement.f_scores.size(), 2U);
}

TEST(SurfaceRecord, IsReadFromTheTableOfTheSurface) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "surface.json", R"({"crs": "EPSG:32617", "voxel_m": 0.09, "triangles": 12, "edges": 30, "boundary_edges": 4,
    "non_manifold_edges": 0, "area_m2": 100.5, "filled_m2": 2.5, "points": 7, "photos": 5, "virtual_views": 3, "seconds": 8.5, "files":
    [{"file": "tiles/tileset.json", "content": "tiles", "format": "3D Tiles 1.1", "crs": "EPSG:4978", "vertical": "", "bytes": 99, "detail": "x"},
     {"content": "without a name"}, 5]})");
  const SurfaceRecord record = ReadSurfaceRecord(folder / "surface.json");
  EXPECT_EQ(record.triangles, 12);
  EXPECT_EQ(record.boundary_edges, 4);
  EXPECT_EQ(record.virtual_views, 3);
  EXPECT_EQ(record.area_m2, 100.5);
  ASSERT_EQ(record.files.size(), 1U);
  EXPECT_EQ(record.files[0].format, "3D Tiles 1.1");
}

TEST(SurfaceRecord, WhatIsMissingOrDamagedIsNotShown) {
  const TemporaryFolder folder;
  EXPECT_EQ(ReadSurfaceRecord(folder / "surface.json").triangles, -1);
  for (const char* text : {"", "[1]", "{\"tri", R"({"triangles": "many", "voxel_m": null, "files": {"file": 1}})"}) {
    base::WriteFileAtomically(folder / "surface.json", text);
    const SurfaceRecord record = ReadSurfaceRecord(folder / "surface.json");
    EXPECT_EQ(record.triangles, -1);
    EXPECT_TRUE(std::isnan(record.voxel_m));
    EXPECT_TRUE(record.files.empty());
  }
}

}  // namespace
}  // namespace skyquilt::evaluate::surface
