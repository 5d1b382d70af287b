#include "tour/format/tour_file.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/tour/format/sample_tour.h"

namespace skyquilt::tour {
namespace {

using TourFileTest = InTemporaryFolder;

std::string ErrorOf(const std::filesystem::path& folder) {
  return InputErrorOf([&] { LoadTourToPlay(folder); });
}

TEST_F(TourFileTest, IsSavedAndLoadedWithTheAssetsThatAreThere) {
  SaveTour(ParseTour(base::JsonText(SampleTour())), folder_.path());
  std::filesystem::create_directories(AssetFolder(folder_.path()));
  base::WriteFileAtomically(AssetFolder(folder_.path()) / kSamplePicture, std::string(1234, 'x'));
  base::WriteFileAtomically(AssetFolder(folder_.path()) / kSampleModel, "not 77 bytes");
  const PlayableTour playable = LoadTourToPlay(folder_.path());
  EXPECT_EQ(playable.tour.stops[0].picture, kSamplePicture);
  EXPECT_EQ(playable.tour.things.size(), 3U);
  ASSERT_EQ(playable.missing.size(), 1U);
  EXPECT_NE(playable.missing[0].find("shed.glb"), std::string::npos) << "half a file is none";
}

TEST_F(TourFileTest, ErrorsNameTheFileAndTheRemedy) {
  EXPECT_NE(ErrorOf(folder_.path()).find("--edit"), std::string::npos);
  base::WriteFileAtomically(TourFile(folder_.path()), SampleTourWith([](nlohmann::json& json) { json["stops"][1]["pause_s"] = "long"; }));
  const std::string error = ErrorOf(folder_.path());
  EXPECT_NE(error.find("tour.json"), std::string::npos);
  EXPECT_NE(error.find("stops[1].pause_s must be a number from 0"), std::string::npos) << error;
}

TEST_F(TourFileTest, ATourThatCouldNotBeReadIsNotSaved) {
  Tour tour = ParseTour(base::JsonText(SampleTour()));
  SaveTour(tour, folder_.path());
  const std::string before = base::ReadFile(TourFile(folder_.path()));
  tour.stops[1].id = "gate";
  EXPECT_THROW(SaveTour(tour, folder_.path()), base::InputError);
  EXPECT_EQ(base::ReadFile(TourFile(folder_.path())), before);
}

}  // namespace
}  // namespace skyquilt::tour
