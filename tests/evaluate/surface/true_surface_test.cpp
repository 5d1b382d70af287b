#include "evaluate/surface/true_surface.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/geo/enu_frame.h"
#include "core/survey/surface_class.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::surface {
namespace {

// As simulate/surface_mesh.cpp writes it.
std::string TruthPly(const std::vector<Eigen::Vector3f>& position, const std::vector<std::array<int32_t, 3>>& faces, uint8_t class_id) {
  std::string ply = "ply\nformat binary_little_endian 1.0\ncomment metres\nelement vertex " + std::to_string(position.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces.size()) +
                    "\nproperty list uchar int vertex_indices\nproperty uchar class\nend_header\n";
  const auto put = [&](const void* value, size_t n) { ply.append(static_cast<const char*>(value), n); };
  for (const Eigen::Vector3f& p : position) put(p.data(), 12);
  for (const auto& face : faces) {
    const uint8_t corners = 3;
    put(&corners, 1);
    put(face.data(), 12);
    put(&class_id, 1);
  }
  return ply;
}

class TrueSurfaceFile : public testing::Test {
 protected:
  TrueSurfaceFile() { std::filesystem::create_directories(file_.parent_path()); }
  TrueSurface Read(const std::string& content) {
    base::WriteFileAtomically(file_, content);
    return ReadTrueSurface(file_, origin_);
  }

  const std::vector<Eigen::Vector3f> position_ = {{0, 0, 10}, {4, 0, 10}, {0, 4, 10}};
  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "truth/surface.ply";
  const geo::Geodetic origin_{47.0, 8.0, 400.0};
};

TEST_F(TrueSurfaceFile, IsReadInTheSurveysFrame) {
  const TrueSurface same = Read(TruthPly(position_, {{0, 1, 2}}, 5));
  ASSERT_EQ(same.triangle.size(), 1U);
  EXPECT_EQ(same.class_id[0], static_cast<uint8_t>(survey::SurfaceClass::kTree));
  EXPECT_NEAR((same.Corner(0, 1) - Eigen::Vector3d(4, 0, 10)).norm(), 0.0, 1e-6);
  EXPECT_NEAR((same.Normal(0) - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-6);
}

TEST_F(TrueSurfaceFile, IsMovedWhenTheSurveyHasAnotherOrigin) {
  const geo::Geodetic simulated{47.01, 8.02, 410.0};
  base::WriteFileAtomically(folder_ / "simulate.json", R"({"origin": {"latitude_deg": 47.01, "longitude_deg": 8.02, "height_m": 410.0}})");
  const TrueSurface moved = Read(TruthPly(position_, {{0, 1, 2}}, 5));
  const Eigen::Vector3d expected = geo::EnuFrame(origin_).EnuFromGeodetic(geo::EnuFrame(simulated).GeodeticFromEnu({4, 0, 10}));
  EXPECT_GT(expected.norm(), 1000.0);
  EXPECT_NEAR((moved.Corner(0, 1) - expected).norm(), 0.0, 1e-5);
  EXPECT_NEAR((moved.survey_from_truth * Eigen::Vector3d(4, 0, 10) - expected).norm(), 0.0, 1e-5);
  base::WriteFileAtomically(folder_ / "simulate.json", "{}");
  EXPECT_THROW(ReadTrueSurface(file_, origin_), base::InputError);
}

TEST_F(TrueSurfaceFile, DamageIsNoticed) {
  const std::string good = TruthPly(position_, {{0, 1, 2}}, 5);
  EXPECT_THROW(Read(good.substr(0, good.size() - 1)), base::InputError);
  EXPECT_THROW(Read(good + "x"), base::InputError);
  EXPECT_THROW(Read(TruthPly(position_, {{0, 1, 3}}, 5)), base::InputError);
  EXPECT_THROW(Read(TruthPly(position_, {{0, 1, -1}}, 5)), base::InputError);
  EXPECT_THROW(Read("ply\nformat ascii 1.0\nend_header\n"), base::InputError);
  EXPECT_THROW(Read(""), base::InputError);
  EXPECT_TRUE(Read(TruthPly({}, {}, 0)).triangle.empty());
}

}  // namespace
}  // namespace skyquilt::evaluate::surface
