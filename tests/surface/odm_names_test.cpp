#include "surface/odm_names.h"

#include <gtest/gtest.h>

#include "core/base/file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

TEST(OdmNames, EveryProductIsFoundWhereOpenDroneMapPutsIt) {
  const TemporaryFolder folder;
  const fs::path surface = folder / "surface";
  const fs::path maps = folder / "products";
  const auto write = [](const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    base::WriteFileAtomically(file, text);
  };
  write(surface / "mesh.obj", "# a\nmtllib mesh.mtl\nusemtl tile_0_0_0\n");
  write(surface / "mesh.mtl", "newmtl tile_0_0_0\nmap_Kd mesh_0_0_0.jpg\n");
  write(surface / "mesh_0_0_0.jpg", "jpeg");
  write(surface / "mesh.glb", "glb");
  write(surface / "cloud_1.las", "first");
  write(surface / "cloud_2.las", "second");
  write(surface / "dtm.tif", "terrain");
  write(surface / "tiles" / "tileset.json", "{}");
  write(surface / "offset.txt", "WGS84 UTM 17N\n300000 4500000\n");
  write(maps / "orthophoto.tif", "ortho");
  write(maps / "dsm.tif", "heights");
  ProvideOdmNames(surface, maps);
  const fs::path odm = surface / "odm";
  EXPECT_EQ(base::ReadFile(odm / "odm_texturing" / "odm_textured_model_geo.obj"), "# a\nmtllib mesh.mtl\nusemtl tile_0_0_0\n");
  EXPECT_EQ(base::ReadFile(odm / "odm_texturing" / "mesh.mtl"), "newmtl tile_0_0_0\nmap_Kd mesh_0_0_0.jpg\n");
  EXPECT_EQ(base::ReadFile(odm / "odm_texturing" / "odm_textured_model_geo.mtl"), "newmtl tile_0_0_0\nmap_Kd mesh_0_0_0.jpg\n");
  EXPECT_EQ(base::ReadFile(odm / "odm_texturing" / "mesh_0_0_0.jpg"), "jpeg");
  EXPECT_EQ(base::ReadFile(odm / "odm_texturing" / "odm_textured_model_geo.glb"), "glb");
  EXPECT_EQ(base::ReadFile(odm / "odm_georeferencing" / "odm_georeferenced_model_2.las"), "second");
  EXPECT_EQ(base::ReadFile(odm / "odm_georeferencing" / "coords.txt"), "WGS84 UTM 17N\n300000 4500000\n");
  EXPECT_EQ(base::ReadFile(odm / "odm_dem" / "dtm.tif"), "terrain");
  EXPECT_EQ(base::ReadFile(odm / "odm_dem" / "dsm.tif"), "heights");
  EXPECT_EQ(base::ReadFile(odm / "odm_orthophoto" / "odm_orthophoto.tif"), "ortho");
  EXPECT_EQ(base::ReadFile(odm / "3d_tiles" / "model" / "tileset.json"), "{}");
}

TEST(OdmNames, AnotherCallReplacesWhatIsThere) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "dtm.tif", "old");
  ProvideOdmNames(folder.path(), folder / "none");
  base::WriteFileAtomically(folder / "dtm.tif", "new");
  ProvideOdmNames(folder.path(), folder / "none");
  EXPECT_EQ(base::ReadFile(folder / "odm" / "odm_dem" / "dtm.tif"), "new");
  EXPECT_FALSE(fs::exists(folder / "odm" / "odm_orthophoto"));
}

}  // namespace
}  // namespace skyquilt::surface
