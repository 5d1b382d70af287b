#include "prepare/input/list_files.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/base/file.h"
#include "prepare/input/input_table.h"
#include "tests/prepare/input/made_folder.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class InputList : public ::testing::Test {
 protected:
  void ExpectKind(const std::string& name, FileKind kind, const std::string& word = "") {
    const InputFile row = folder_.Row(name);
    EXPECT_EQ(row.name, name) << "is not listed";
    EXPECT_EQ(KindName(row.kind), KindName(kind)) << name << ": " << row.reason;
    EXPECT_NE(row.reason.find(word), std::string::npos) << name << ": " << row.reason;
  }
  std::string Failure(const std::string& patterns = "") {
    return InputErrorOf([&] { folder_.Taken(patterns); });
  }
  void ExpectInFailure(const std::string& patterns, const Names& words) {
    const std::string message = Failure(patterns);
    for (const std::string& word : words) EXPECT_NE(message.find(word), std::string::npos) << word << ": " << message;
  }

  test::MadeFolder folder_;
};

TEST_F(InputList, TakesEveryPictureOfPlainFoldersInNameOrder) {
  folder_.AddAll({"b.JPG", "a.jpg", "100MEDIA/DJI_0001.JPG", "100MEDIA/geo.txt", "c.png", "d.TIFF", "notes.txt", "100MEDIA/flight.MRK"});
  EXPECT_EQ(folder_.Taken(), (Names{"100MEDIA/DJI_0001.JPG", "a.jpg", "b.JPG", "c.png", "d.TIFF"}));
  ExpectKind("notes.txt", FileKind::kOther);
  for (const InputFile& file : folder_.List()) EXPECT_EQ(file.Taken(), file.reason.empty()) << file.name;
}

TEST_F(InputList, FilesOfOneNumberInSeveralFoldersAreDifferentPhotos) {
  folder_.AddAll({"flight1/DJI_0001.JPG", "flight2/DJI_0001.JPG", "flight3/DJI_0001.png"});
  EXPECT_EQ(folder_.Taken().size(), 3U);
}

TEST_F(InputList, BandsBesidePhotosInColourAreLeftOut) {
  for (const char* shot : {"0001", "0002", "0003"}) {
    const std::string stem = std::string("DJI_20230501120000_") + shot;
    for (const char* band : {"_MS_G.TIF", "_MS_R.TIF", "_MS_RE.TIF", "_MS_NIR.TIF"}) folder_.Add(stem + band);
    folder_.Add(stem + "_D.JPG");
  }
  EXPECT_EQ(folder_.Taken(), (Names{"DJI_20230501120000_0001_D.JPG", "DJI_20230501120000_0002_D.JPG", "DJI_20230501120000_0003_D.JPG"}));
  ExpectKind("DJI_20230501120000_0002_MS_NIR.TIF", FileKind::kBand);
  EXPECT_EQ(folder_.Row("DJI_20230501120000_0002_MS_NIR.TIF").shot, folder_.Row("DJI_20230501120000_0002_D.JPG").shot);
}

// Phantom 4 Multispectral counts on, Parrot has names of its own.
TEST_F(InputList, BandsOfOtherDronesAreLeftOutToo) {
  for (const char* tens : {"001", "002", "003"}) {
    folder_.AddJpeg(std::string("DJI_") + tens + "0.JPG");
    for (const char* band : {"1.TIF", "2.TIF", "3.TIF", "4.TIF", "5.TIF"}) folder_.Add(std::string("DJI_") + tens + band, test::TiffHeader(16, 8, 1));
  }
  folder_.Add("IMG_180501_0000_GRE.TIF");
  folder_.Add("IMG_180501_0000_RGB.JPG");
  folder_.Add("IMG_0007_1.tif", test::TiffHeader(16, 8, 1));
  EXPECT_EQ(folder_.Taken(), (Names{"DJI_0010.JPG", "DJI_0020.JPG", "DJI_0030.JPG", "IMG_180501_0000_RGB.JPG"}));
  ExpectKind("DJI_0013.TIF", FileKind::kBand, "one channel");
  ExpectKind("IMG_180501_0000_GRE.TIF", FileKind::kBand);
  ExpectKind("IMG_0007_1.tif", FileKind::kBand);
}

TEST_F(InputList, AFolderOfBandsAloneGivesOneOfThem) {
  for (const char* shot : {"IMG_0001", "IMG_0002", "IMG_0003"}) {
    for (const char* band : {"_1.tif", "_2.tif", "_3.tif", "_4.tif", "_5.tif"}) folder_.Add(std::string(shot) + band, test::TiffHeader(16, 8, 1));
  }
  // One picture of the pilot is not what the flight was for.
  folder_.AddJpeg("pilot.jpg");
  EXPECT_EQ(folder_.Taken("*.tif").size(), 15U);
  EXPECT_EQ(folder_.Taken(), (Names{"IMG_0001_2.tif", "IMG_0002_2.tif", "IMG_0003_2.tif", "pilot.jpg"}));
  ExpectKind("IMG_0001_4.tif", FileKind::kBand, "band 2");
  const Names warnings = InputWarnings(folder_.path(), folder_.List());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("prepare.photos"), std::string::npos) << warnings[0];
  EXPECT_EQ(folder_.Taken("*_5.tif").size(), 3U);
}

TEST_F(InputList, TheSharpestBandIsTaken) {
  for (const char* shot : {"IMG_0001", "IMG_0002", "IMG_0003"}) {
    for (const char* band : {"_1.tif", "_2.tif", "_3.tif"}) folder_.Add(std::string(shot) + band, test::TiffHeader(16, 8, 1));
    folder_.Add(std::string(shot) + "_6.tif", test::TiffHeader(32, 16, 1));
  }
  EXPECT_EQ(folder_.Taken(), (Names{"IMG_0001_6.tif", "IMG_0002_6.tif", "IMG_0003_6.tif"}));
}

TEST_F(InputList, GrayOrNumberedPhotosThatAreNoBandsAreTaken) {
  folder_.Add("scan_1.tif", test::TiffHeader(16, 8, 3));
  folder_.Add("scan_2.tif", test::TiffHeader(16, 8, 3));
  folder_.Add("scan_3.tif", test::TiffHeader(16, 8, 3));
  folder_.Add("wall_red.tif", test::TiffHeader(16, 8, 3));
  folder_.AddAll({"house_1.jpg", "house_2.jpg", "house_3.jpg"});
  EXPECT_EQ(folder_.Taken().size(), 7U);
}

TEST_F(InputList, OldGrayPhotosWithoutColoursBesideAreTaken) {
  for (const char* strip : {"strip1", "strip2", "strip3"}) {
    for (const char* number : {"_1.tif", "_2.tif", "_3.tif", "_4.tif"}) folder_.Add(std::string(strip) + number, test::TiffHeader(16, 8, 1));
  }
  EXPECT_EQ(folder_.Taken().size(), 12U);
}

TEST_F(InputList, PicturesOfHeatAreLeftOutByName) {
  for (const char* shot : {"DJI_20230101_0001", "DJI_20230101_0002"}) {
    for (const char* camera : {"_W.JPG", "_Z.JPG", "_T.JPG"}) folder_.Add(std::string(shot) + camera);
  }
  folder_.AddAll({"other/MAX_0001.JPG", "other/IRX_0001.jpg", "third/IMG_7.jpg", "third/IMG_7_IR.jpg"});
  EXPECT_EQ(folder_.Taken(), (Names{"DJI_20230101_0001_W.JPG", "DJI_20230101_0001_Z.JPG", "DJI_20230101_0002_W.JPG", "DJI_20230101_0002_Z.JPG",
                                    "other/MAX_0001.JPG", "third/IMG_7.jpg"}));
  ExpectKind("DJI_20230101_0001_T.JPG", FileKind::kThermal);
}

TEST_F(InputList, AFlightOfHeatAloneIsTaken) {
  folder_.AddAll({"DJI_0001_T.JPG", "DJI_0002_T.JPG", "DJI_0003_T.JPG"});
  EXPECT_EQ(folder_.Taken().size(), 3U);
}

TEST_F(InputList, PicturesOfHeatAreLeftOutBySize) {
  for (int i = 1; i <= 6; ++i)
    folder_.Add("DJI_000" + std::to_string(i) + ".tif", test::TiffHeader(i % 2 == 0 ? 640 : 4000, i % 2 == 0 ? 512 : 3000, 3));
  EXPECT_EQ(folder_.Taken(), (Names{"DJI_0001.tif", "DJI_0003.tif", "DJI_0005.tif"}));
  ExpectKind("DJI_0002.tif", FileKind::kThermal, "640x512");
  EXPECT_EQ(folder_.Row("DJI_0001.tif").width, 4000);
}

TEST_F(InputList, SmallPhotosAloneOrOfOneSizeAreTaken) {
  for (int i = 0; i < 4; ++i) folder_.Add("small_" + std::to_string(i) + "x.tif", test::TiffHeader(640, 480, 3));
  EXPECT_EQ(folder_.Taken().size(), 4U);
}

TEST_F(InputList, FoldersOfSystemsAndThumbnailsAreLeftOut) {
  folder_.AddAll({"a.jpg", "._a.jpg", ".hidden.jpg", "@eaDir/a.jpg/SYNOPHOTO_THUMB_XL.jpg", ".thumbnails/a.jpg", "__MACOSX/._a.jpg",
                  "$RECYCLE.BIN/b.jpg", "lost+found/c.jpg", "Thumbs/a.jpg", "thumb_a.jpg", "a_thumb.jpg", "Thumbs.db", "flight/@eaDir/x.jpg",
                  "flight/b.jpg"});
  EXPECT_EQ(folder_.Taken(), (Names{"a.jpg", "flight/b.jpg"}));
  ExpectKind("._a.jpg", FileKind::kSystem, "macOS");
  ExpectKind("@eaDir/", FileKind::kSystem);
  ExpectKind("flight/@eaDir/", FileKind::kSystem);
  ExpectKind("Thumbs/a.jpg", FileKind::kThumbnail);
  ExpectKind("thumb_a.jpg", FileKind::kThumbnail);
}

// lost+found belongs to root.
TEST_F(InputList, SystemFoldersNeedNotBeReadable) {
  folder_.Add("a.jpg");
  fs::create_directories(folder_.path() / "lost+found");
  fs::permissions(folder_.path() / "lost+found", fs::perms::none);
  EXPECT_EQ(folder_.Taken(), Names{"a.jpg"});
  fs::permissions(folder_.path() / "lost+found", fs::perms::owner_all);
}

TEST_F(InputList, ProjectsAmongThePhotosAreLeftOutAsFolders) {
  folder_.AddAll({"a.jpg", "b.jpg", "out/survey/survey.json", "out/products/orthophoto.tif", "out/report/images/x.png", "odm/images/a.jpg",
                  "odm/odm_orthophoto/odm_orthophoto.tif", "odm/odm_texturing/t.png", "colmap/images/a.jpg", "colmap/sparse/0/cameras.bin",
                  "colmap/stereo/depth.png", "nerf/transforms.json", "nerf/images/frame_00001.png", "nerf/images_2/frame_00001.png"});
  EXPECT_EQ(folder_.Taken(), (Names{"a.jpg", "b.jpg"}));
  ExpectKind("out/", FileKind::kProject, "a Skyquilt project, with 2 pictures");
  ExpectKind("odm/", FileKind::kProject, "OpenDroneMap");
  ExpectKind("colmap/", FileKind::kProject, "COLMAP");
  ExpectKind("nerf/", FileKind::kProject, "nerfstudio");
  EXPECT_EQ(InputWarnings(folder_.path(), folder_.List()).size(), 1U);
  EXPECT_EQ(folder_.Taken("odm/images/*"), Names{"odm/images/a.jpg"});
}

TEST_F(InputList, ImagesOfProjectsAreTakenWhereThereAreNoOthersOfThem) {
  folder_.AddAll({"flight1/images/a.jpg", "flight1/sparse/0/cameras.txt", "flight1/masks/a.jpg.png", "flight2/b.jpg", "flight3/images/c.jpg",
                  "flight3/odm_dem/dsm.tif", "copy/images/b.jpg", "copy/images/sub/b.jpg", "copy/opensfm/undistorted/b.tif"});
  EXPECT_EQ(folder_.Taken(), (Names{"flight1/images/a.jpg", "flight2/b.jpg", "flight3/images/c.jpg"}));
  ExpectKind("flight1/masks/a.jpg.png", FileKind::kMask);
  ExpectKind("copy/", FileKind::kProject);
  ExpectKind("flight1/", FileKind::kResult, "whose images/ are taken");
}

TEST_F(InputList, ResultsInAProjectThatIsThePhotoFolderAreLeftOut) {
  folder_.AddAll(
      {"a.jpg", "b.jpg", "odm_orthophoto/odm_orthophoto.tif", "mve/views/x.png", "images_2/a.jpg", "images/c.jpg", "simulated/truth/x.png"});
  EXPECT_EQ(folder_.Taken(), (Names{"a.jpg", "b.jpg", "images/c.jpg", "simulated/truth/x.png"}));
  folder_.Add("simulated/simulate.json");
  EXPECT_EQ(folder_.Taken(), (Names{"a.jpg", "b.jpg", "images/c.jpg"}));
  ExpectKind("simulated/truth/", FileKind::kResult);
  ExpectKind("images_2/", FileKind::kResult, "smaller copies");
}

TEST_F(InputList, MapsAreNoPhotos) {
  folder_.AddAll({"a.jpg", "odm_orthophoto.tif", "DSM.TIF"});
  folder_.Add("site.tif", test::TiffHeader(16, 8, 3, -1, true));
  folder_.Add("photo.tif", test::TiffHeader(16, 8, 3));
  EXPECT_EQ(folder_.Taken(), (Names{"a.jpg", "photo.tif"}));
  ExpectKind("site.tif", FileKind::kMap, "GeoTIFF");
}

TEST_F(InputList, OneFormOfAShotIsTaken) {
  folder_.AddAll({"a.JPG", "a.DNG", "a.heic", "a.tif", "b.tif", "b.png", "c.DNG", "c.JPG.xmp", "d.mp4", "d.jpg", "e.heic", "e.dng", "f.X3F"});
  EXPECT_EQ(folder_.Taken(), (Names{"a.JPG", "b.tif", "c.DNG", "d.jpg", "e.heic"}));
  ExpectKind("a.DNG", FileKind::kOtherForm, "another form of a.JPG");
  ExpectKind("a.tif", FileKind::kOtherForm, "another form of a.JPG");
  ExpectKind("d.mp4", FileKind::kOtherForm);
  ExpectKind("e.dng", FileKind::kOtherForm, "another form of e.heic");
  ExpectKind("f.X3F", FileKind::kUnread, "raw");
  const Names warnings = InputWarnings(folder_.path(), folder_.List());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("1 raw pictures are left out"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("darktable-cli"), std::string::npos) << warnings[0];
  EXPECT_EQ(folder_.Taken("*.tif"), (Names{"a.tif", "b.tif"}));
}

TEST_F(InputList, MasksBesidePhotosAreNoPhotos) {
  folder_.AddJpeg("a.jpg");
  folder_.AddPng("a.png", image::Image8(16, 8, 1, 255));  // in black and white
  folder_.AddJpeg("b.jpg");
  folder_.AddAll(
      {"b_mask.png", "c.jpg", "c.jpg.png", "d.jpg", "D_MASK.tif", "mask.png", "flight/camera_mask.png", "flight/masks/e.png", "flight/e.jpg"});
  EXPECT_EQ(folder_.Taken(), (Names{"a.jpg", "b.jpg", "c.jpg", "d.jpg", "flight/e.jpg"}));
  for (const char* name : {"a.png", "b_mask.png", "c.jpg.png", "D_MASK.tif", "mask.png", "flight/camera_mask.png", "flight/masks/e.png"}) {
    ExpectKind(name, FileKind::kMask);
  }
  // Not even by a pattern.
  EXPECT_EQ(folder_.Taken("*.jpg, *.png").size(), 5U);
}

TEST_F(InputList, PatternsChooseAndOverrule) {
  folder_.AddAll({"flight1/a.JPG", "flight1/a.tif", "flight2/b.jpg", "flight2/thumbs/b.jpg", "c.jpg"});
  EXPECT_EQ(folder_.Taken("flight1/*"), (Names{"flight1/a.JPG", "flight1/a.tif"}));
  EXPECT_EQ(folder_.Taken("*.JPG"), (Names{"c.jpg", "flight1/a.JPG", "flight2/b.jpg", "flight2/thumbs/b.jpg"}));
  EXPECT_EQ(folder_.Taken("flight2/**, c.*"), (Names{"c.jpg", "flight2/b.jpg", "flight2/thumbs/b.jpg"}));
  ExpectKind("flight1/a.JPG", FileKind::kNoChoice);
  ExpectKind("flight2/thumbs/b.jpg", FileKind::kPhoto, "chosen");
  ExpectInFailure("*.bmp", {"'*.bmp'", "for instance c.jpg, flight1/a.JPG, flight1/a.tif", "flight1/*"});
  EXPECT_NE(UsageErrorOf([&] { folder_.Taken(" , "); }).find("prepare.photos"), std::string::npos);
}

TEST_F(InputList, AFolderWithoutPhotosSaysWhatItHas) {
  ExpectInFailure("", {"has no photos (.jpg", "Give the folder that holds the photos"});
  folder_.AddAll({"a.X3F", "b.X3F", "x.mp4", "notes.txt"});
  ExpectInFailure("", {"3 files in formats that cannot be read", "darktable-cli"});
}

TEST_F(InputList, FoldersOfTheProjectItselfAreNoInput) {
  folder_.AddAll({"a.jpg", "out/survey/x.png", "out/y.png"});
  ListOptions options;
  options.skip = {folder_.path() / "out"};
  const std::vector<InputFile> files = folder_.List(options);
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].name, "a.jpg");
}

TEST_F(InputList, ALinkToAParentIsAnError) {
  folder_.Add("deep/a.jpg");
  fs::create_directory_symlink(folder_.path(), folder_.path() / "deep/loop");
  EXPECT_NE(Failure().find("nested deeper than 32"), std::string::npos);
}

TEST_F(InputList, TheTableHasALinePerFileAndTheSummaryTheirNumbers) {
  folder_.AddJpeg("a.jpg");
  folder_.AddAll({"a.dng", "b, c.jpg", "thumb_a.jpg", "notes.txt"});
  const std::vector<InputFile> files = folder_.List();
  WriteInputTable(files, folder_.path() / "input.csv");
  const std::string text = base::ReadFile(folder_.path() / "input.csv");
  EXPECT_TRUE(text.starts_with("file,taken,kind,reason,shot,mask,width,height\na.dng,no,other form,")) << text;
  EXPECT_NE(text.find("a.jpg,yes,photo,,a,,16,8\n\"b, c.jpg\",yes,photo,,\"b, c\",,,\nnotes.txt,no,other file,"), std::string::npos) << text;
  const std::string summary = SummaryText(files, "out/input.csv");
  EXPECT_EQ(summary, "input: 2 photos are taken, left out are 1 other form of a photo, 1 thumbnail; out/input.csv lists every file");
}

}  // namespace
}  // namespace skyquilt::prepare::input
