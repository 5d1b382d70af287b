#include "core/survey/exif.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <exiv2/exiv2.hpp>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/image/image.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::survey {
namespace {

std::filesystem::path MakeJpeg(const TemporaryFolder& folder) {
  std::filesystem::path file = folder / "photo.jpg";
  image::SaveJpeg(image::Image8(16, 8, 3, 128), file, 90);
  return file;
}

PhotoTags RoundTrip(const PhotoTags& tags) {
  const TemporaryFolder folder;
  const auto file = MakeJpeg(folder);
  WritePhotoTags(tags, file);
  return ReadPhotoTags(file);
}

// Sets tags directly through Exiv2, as other programs write them.
template <typename Edit>
PhotoTags ReadForged(const Edit& edit) {
  const TemporaryFolder folder;
  const auto file = MakeJpeg(folder);
  WritePhotoTags({}, file);
  const auto image = Exiv2::ImageFactory::open(file.string());
  image->readMetadata();
  edit(image->exifData(), image->xmpData());
  image->writeMetadata();
  return ReadPhotoTags(file);
}

void SetExifPosition(Exiv2::ExifData& exif) {
  exif["Exif.GPSInfo.GPSLatitude"] = "46/1 50/1 3000/100";
  exif["Exif.GPSInfo.GPSLatitudeRef"] = "N";
  exif["Exif.GPSInfo.GPSLongitude"] = "91/1 30/1 0/1";
  exif["Exif.GPSInfo.GPSLongitudeRef"] = "W";
}

TEST(Exif, PanoramasSayWhatTheyShow) {
  PhotoTags tags;
  EXPECT_FALSE(RoundTrip(tags).panorama);
  tags.panorama = PanoramaTags{
      .heading_deg = 271.25, .pitch_deg = -3.5, .roll_deg = 0.0, .full_width = 8192, .full_height = 4096, .left = 12, .top = 100, .area_width = 8000};
  const PhotoTags read = RoundTrip(tags);
  ASSERT_TRUE(read.panorama);
  EXPECT_EQ(read.panorama->heading_deg, 271.25);
  EXPECT_EQ(read.panorama->pitch_deg, -3.5);
  EXPECT_EQ(read.panorama->roll_deg, 0.0);
  EXPECT_EQ(read.panorama->full_width, 8192);
  EXPECT_EQ(read.panorama->full_height, 4096);
  EXPECT_EQ(read.panorama->left, 12);
  EXPECT_EQ(read.panorama->top, 100);
  EXPECT_EQ(read.panorama->area_width, 8000);
}

TEST(Exif, OtherProjectionsAndWildSizesAreNoPanorama) {
  EXPECT_FALSE(ReadForged([](auto&, auto& xmp) { xmp["Xmp.GPano.ProjectionType"] = "cylindrical"; }).panorama);
  const PhotoTags wild = ReadForged([](auto&, auto& xmp) {
    xmp["Xmp.GPano.ProjectionType"] = "equirectangular";
    xmp["Xmp.GPano.FullPanoWidthPixels"] = "1e300";
    xmp["Xmp.GPano.FullPanoHeightPixels"] = "-5";
    xmp["Xmp.GPano.PoseHeadingDegrees"] = "north";
  });
  ASSERT_TRUE(wild.panorama);
  EXPECT_EQ(wild.panorama->full_width, 0);
  EXPECT_EQ(wild.panorama->full_height, 0);
  EXPECT_FALSE(wild.panorama->heading_deg);
}

TEST(Exif, PositionsSurviveTheRoundTripEverywhereOnEarth) {
  const geo::Geodetic positions[] = {
      {90.0, 0.0, 2835.0},        {-90.0, 12.0, 2835.0},  {0.0, -180.0, 10.0},          {12.5, 179.999999999, 10.0}, {-33.8567844, 151.2152967, 5},
      {46.8427, -91.994, 198.31}, {31.5, 35.47, -430.25}, {-0.00001, -0.00001, -0.004}, {59.99999999999, 10.0, 1.0}, {-54.801944, -68.303056, 9000}};
  for (const geo::Geodetic& position : positions) {
    PhotoTags tags;
    tags.gps = position;
    const PhotoTags read = RoundTrip(tags);
    ASSERT_TRUE(read.gps) << position.latitude_deg << " " << position.longitude_deg;
    EXPECT_NEAR(read.gps->latitude_deg, position.latitude_deg, 2e-9);
    EXPECT_NEAR(geo::WrapLongitudeDeg(read.gps->longitude_deg - position.longitude_deg), 0.0, 2e-9);
    EXPECT_GE(read.gps->longitude_deg, -180.0);
    EXPECT_LT(read.gps->longitude_deg, 180.0);
    EXPECT_NEAR(read.gps->height_m, position.height_m, 1e-3);
  }
}

TEST(Exif, EveryTagSurvivesTheRoundTrip) {
  PhotoTags tags;
  tags.gps = geo::Geodetic{-12.0, 130.0, 77.5};
  tags.absolute_altitude_m = 77.5;
  tags.relative_altitude_m = -3.25;
  tags.rtk = true;
  tags.gimbal_yaw_deg = -170.5;
  tags.gimbal_pitch_deg = -89.9;
  tags.gimbal_roll_deg = 0.1;
  tags.exposure = {1.0 / 546.0, 2.8, 100.0};
  tags.focal_length_mm = 3.61;
  tags.focal_length_35mm = 20.0;
  tags.original_width = 4000;
  tags.original_height = 2250;
  tags.capture_time_s = 1466699519.9996;  // rounds up into the next second
  tags.make = "DJI";
  tags.model = "FC300S";
  const PhotoTags read = RoundTrip(tags);
  EXPECT_NEAR(*read.absolute_altitude_m, 77.5, 1e-3);
  EXPECT_NEAR(*read.relative_altitude_m, -3.25, 1e-3);
  EXPECT_TRUE(read.rtk);
  EXPECT_NEAR(*read.gimbal_yaw_deg, -170.5, 0.01);
  EXPECT_NEAR(*read.gimbal_pitch_deg, -89.9, 0.01);
  EXPECT_NEAR(*read.gimbal_roll_deg, 0.1, 0.01);
  EXPECT_NEAR(*read.exposure.time_s, 1.0 / 546.0, 1e-8);
  EXPECT_NEAR(*read.exposure.f_number, 2.8, 1e-3);
  EXPECT_EQ(*read.exposure.iso, 100.0);
  EXPECT_NEAR(*read.focal_length_mm, 3.61, 1e-4);
  EXPECT_EQ(*read.focal_length_35mm, 20.0);
  EXPECT_EQ(read.original_width, 4000);
  EXPECT_EQ(read.original_height, 2250);
  EXPECT_NEAR(*read.capture_time_s, 1466699520.0, 1e-3);
  EXPECT_EQ(read.make, "DJI");
  EXPECT_EQ(read.model, "FC300S");
}

TEST(Exif, AccuracyAndSpeedSurviveTheRoundTripWithAndWithoutRtk) {
  PhotoTags tags;
  tags.horizontal_accuracy_m = 0.0123;
  tags.vertical_accuracy_m = 0.0271;
  tags.dop = 1.25;
  tags.speed_mps = 13.417;
  for (const bool rtk : {true, false}) {
    tags.rtk = rtk;
    const PhotoTags read = RoundTrip(tags);
    EXPECT_EQ(read.rtk, rtk);
    ASSERT_TRUE(read.horizontal_accuracy_m && read.vertical_accuracy_m && read.dop && read.speed_mps) << rtk;
    EXPECT_NEAR(*read.horizontal_accuracy_m, 0.0123, 1e-9);
    EXPECT_NEAR(*read.vertical_accuracy_m, 0.0271, 1e-9);
    EXPECT_NEAR(*read.dop, 1.25, 1e-9);
    EXPECT_NEAR(*read.speed_mps, 13.417, 2e-5);
  }
  tags.speed_mps = 0.0;
  EXPECT_EQ(RoundTrip(tags).speed_mps, 0.0);
}

TEST(Exif, AnUnknownHeightIsNotWritten) {
  PhotoTags tags;
  tags.gps = geo::Geodetic{46.0, 7.0, std::numeric_limits<double>::quiet_NaN()};
  const PhotoTags read = RoundTrip(tags);
  ASSERT_TRUE(read.gps);
  EXPECT_NEAR(read.gps->latitude_deg, 46.0, 1e-9);
  EXPECT_TRUE(std::isnan(read.gps->height_m));
  EXPECT_FALSE(read.absolute_altitude_m);
}

TEST(Exif, RtkAccuracyIsTheLargerOfTheTwoAndZeroIsNone) {
  const PhotoTags both = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData& xmp) {
    xmp["Xmp.drone-dji.RtkStdLon"] = "0.01";
    xmp["Xmp.drone-dji.RtkStdLat"] = "+0.03";
    xmp["Xmp.drone-dji.RtkStdHgt"] = "0.05";
    exif["Exif.GPSInfo.0x001f"] = Exiv2::URational(5, 1);
  });
  EXPECT_EQ(both.horizontal_accuracy_m, 0.03);
  EXPECT_EQ(both.vertical_accuracy_m, 0.05);
  // As drones without RTK write it.
  const PhotoTags none = ReadForged([](Exiv2::ExifData&, Exiv2::XmpData& xmp) {
    for (const char* key : {"Xmp.drone-dji.RtkStdLon", "Xmp.drone-dji.RtkStdLat", "Xmp.drone-dji.RtkStdHgt"}) xmp[key] = "0.00000";
  });
  EXPECT_FALSE(none.horizontal_accuracy_m);
  EXPECT_FALSE(none.vertical_accuracy_m);
  const PhotoTags exif_only = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData& xmp) {
    xmp["Xmp.drone-dji.RtkStdLon"] = "0.0";
    exif["Exif.GPSInfo.0x001f"] = Exiv2::URational(45, 10);
    exif["Exif.GPSInfo.GPSDOP"] = Exiv2::URational(0, 1);
  });
  EXPECT_EQ(exif_only.horizontal_accuracy_m, 4.5);
  EXPECT_FALSE(exif_only.vertical_accuracy_m);
  EXPECT_FALSE(exif_only.dop);
}

// Pix4D's namespace is written with and without a slash at its end.
TEST(Exif, Pix4dAccuracyIsReadBeforeExif) {
  for (const std::string uri : {"http://pix4d.com/camera/1.0", "http://pix4d.com/camera/1.0/"}) {
    const TemporaryFolder folder;
    const auto file = MakeJpeg(folder);
    const auto image = Exiv2::ImageFactory::open(file.string());
    image->readMetadata();
    image->exifData()["Exif.GPSInfo.0x001f"] = Exiv2::URational(9, 1);
    image->setXmpPacket(R"(<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#">)"
                        R"(<rdf:Description rdf:about="" xmlns:Camera=")" +
                        uri + R"(" Camera:GPSXYAccuracy="1.5" Camera:GPSZAccuracy="2.25"/></rdf:RDF></x:xmpmeta>)");
    image->writeXmpFromPacket(true);
    image->writeMetadata();
    const PhotoTags tags = ReadPhotoTags(file);
    EXPECT_EQ(tags.horizontal_accuracy_m, 1.5) << uri;
    EXPECT_EQ(tags.vertical_accuracy_m, 2.25) << uri;
  }
}

TEST(Exif, SpeedComesFromDjiFirstAndExifHasThreeUnits) {
  const PhotoTags dji = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData& xmp) {
    xmp["Xmp.drone-dji.FlightXSpeed"] = "+3.0";
    xmp["Xmp.drone-dji.FlightYSpeed"] = "-4.0";
    xmp["Xmp.drone-dji.FlightZSpeed"] = "+1.0";
    exif["Exif.GPSInfo.GPSSpeed"] = Exiv2::URational(99, 1);
  });
  EXPECT_NEAR(*dji.speed_mps, 5.0, 1e-12);
  const auto read = [](const char* unit) {
    return ReadForged([&](Exiv2::ExifData& exif, Exiv2::XmpData&) {
             exif["Exif.GPSInfo.GPSSpeed"] = Exiv2::URational(360, 10);
             if (*unit != '\0') exif["Exif.GPSInfo.GPSSpeedRef"] = unit;
           })
        .speed_mps;
  };
  EXPECT_NEAR(*read("K"), 10.0, 1e-12);
  EXPECT_NEAR(*read("M"), 16.093440, 1e-9);
  EXPECT_NEAR(*read("N"), 18.52, 1e-9);
  EXPECT_NEAR(*read(""), 10.0, 1e-12);
  EXPECT_FALSE(read("X"));
}

TEST(Exif, NumbersWithOtherTextAreAbsent) {
  const auto read = [](const char* text) {
    return ReadForged([&](Exiv2::ExifData&, Exiv2::XmpData& xmp) { xmp["Xmp.drone-dji.RelativeAltitude"] = text; }).relative_altitude_m;
  };
  EXPECT_EQ(read("12"), 12.0);
  EXPECT_EQ(read("  +12.5 \n"), 12.5);
  EXPECT_EQ(read("-1e1 "), -10.0);
  EXPECT_EQ(read("1500/10"), 150.0);
  EXPECT_EQ(read("1500/10 "), 150.0);
  for (const char* text : {"12abc", "12 m", "12,5", "1500/10x", "1500/", "1500/0", "+-12", "abc", " ", "nan", "inf"})
    EXPECT_FALSE(read(text)) << text;
}

TEST(Exif, AnUntaggedPhotoHasNoTags) {
  const PhotoTags read = RoundTrip({});
  EXPECT_FALSE(read.horizontal_accuracy_m);
  EXPECT_FALSE(read.vertical_accuracy_m);
  EXPECT_FALSE(read.dop);
  EXPECT_FALSE(read.speed_mps);
  EXPECT_FALSE(read.gps);
  EXPECT_FALSE(read.relative_altitude_m);
  EXPECT_FALSE(read.exposure.time_s);
  EXPECT_FALSE(read.capture_time_s);
  EXPECT_FALSE(read.rtk);
}

TEST(Exif, XmpAltitudeWithoutLatitudeIsNoPosition) {
  const PhotoTags read = ReadForged([](Exiv2::ExifData&, Exiv2::XmpData& xmp) { xmp["Xmp.drone-dji.AbsoluteAltitude"] = "+198.31"; });
  EXPECT_FALSE(read.gps);
  EXPECT_NEAR(*read.absolute_altitude_m, 198.31, 1e-9);
}

TEST(Exif, XmpAltitudeCompletesExifLatitude) {
  const PhotoTags read = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData& xmp) {
    SetExifPosition(exif);
    exif["Exif.GPSInfo.GPSAltitude"] = "198/1";  // rounded by some rewriting program
    xmp["Xmp.drone-dji.AbsoluteAltitude"] = "+198.31";
  });
  ASSERT_TRUE(read.gps);
  EXPECT_NEAR(read.gps->latitude_deg, 46.0 + 50.0 / 60.0 + 30.0 / 3600.0, 1e-12);
  EXPECT_NEAR(read.gps->longitude_deg, -91.5, 1e-12);
  EXPECT_NEAR(read.gps->height_m, 198.31, 1e-9);
}

TEST(Exif, XmpPositionWinsOverTruncatedExifAlsoWithDjisSpelling) {
  const PhotoTags read = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData& xmp) {
    SetExifPosition(exif);
    xmp["Xmp.drone-dji.GpsLatitude"] = "46.84171234";
    xmp["Xmp.drone-dji.GpsLongtitude"] = "-91.50001234";
  });
  EXPECT_DOUBLE_EQ(read.gps->latitude_deg, 46.84171234);
  EXPECT_DOUBLE_EQ(read.gps->longitude_deg, -91.50001234);
  EXPECT_TRUE(std::isnan(read.gps->height_m));
}

TEST(Exif, AltitudeReferenceOneIsBelowSeaLevel) {
  const PhotoTags read = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData&) {
    SetExifPosition(exif);
    exif["Exif.GPSInfo.GPSAltitude"] = "4305/10";
    Exiv2::DataValue below(Exiv2::unsignedByte);
    below.read("1");
    exif["Exif.GPSInfo.GPSAltitudeRef"].setValue(&below);
  });
  EXPECT_DOUBLE_EQ(read.gps->height_m, -430.5);
}

TEST(Exif, ZeroZeroIsNoFixAndBrokenRationalsAreAbsent) {
  const PhotoTags no_fix = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData&) {
    SetExifPosition(exif);
    exif["Exif.GPSInfo.GPSLatitude"] = "0/1 0/1 0/1";
    exif["Exif.GPSInfo.GPSLongitude"] = "0/1 0/1 0/1";
  });
  EXPECT_FALSE(no_fix.gps);
  const PhotoTags broken = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData&) {
    SetExifPosition(exif);
    exif["Exif.GPSInfo.GPSLatitude"] = "46/0 0/0 0/0";
    exif["Exif.Photo.ExposureTime"] = "1/0";
    exif["Exif.Photo.DateTimeOriginal"] = "0000:00:00 00:00:00";
  });
  EXPECT_FALSE(broken.gps);
  EXPECT_FALSE(broken.exposure.time_s);
  EXPECT_FALSE(broken.capture_time_s);
}

TEST(Exif, AFileThatIsNoImageIsRefusedByName) {
  const TemporaryFolder folder;
  std::ofstream(folder / "notes.jpg") << "these are notes, not a photo";
  EXPECT_NE(InputErrorOf([&] { ReadPhotoTags(folder / "notes.jpg"); }).find("notes.jpg"), std::string::npos);
  EXPECT_THROW(ReadPhotoTags(folder / "absent.jpg"), base::InputError);
}

TEST(Exif, RealDjiTagsAreRead) {
  const char* data = std::getenv("SKYQUILT_DATA");
  const auto file = std::filesystem::path(data == nullptr ? "../shared/data" : data) / "brighton_beach/images/DJI_0018.JPG";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no real photos at " << file;
  const PhotoTags tags = ReadPhotoTags(file);
  ASSERT_TRUE(tags.gps);
  EXPECT_NEAR(tags.gps->latitude_deg, 46.8427, 0.002);
  EXPECT_NEAR(tags.gps->longitude_deg, -91.994, 0.002);
  EXPECT_NEAR(tags.gps->height_m, 198.31, 1e-6);
  EXPECT_NEAR(*tags.relative_altitude_m, 39.8, 1e-6);
  EXPECT_NEAR(*tags.gimbal_pitch_deg, -89.9, 1e-6);
  EXPECT_NEAR(*tags.exposure.time_s, 0.002702, 1e-6);
  EXPECT_NEAR(*tags.exposure.f_number, 2.8, 1e-6);
  EXPECT_EQ(*tags.exposure.iso, 100.0);
  EXPECT_EQ(*tags.capture_time_s, 1466699519.0);  // 2016-06-23 16:31:59
  EXPECT_EQ(tags.model, "FC300S");
}

TEST(Exif, SizesThatCannotBeAreLeftOut) {
  for (const char* width : {"0", "4294967295"}) {
    const PhotoTags tags = ReadForged([&](Exiv2::ExifData& exif, Exiv2::XmpData&) {
      Exiv2::ULongValue value;
      value.read(width);
      exif["Exif.Photo.PixelXDimension"] = value;
      exif["Exif.Photo.PixelYDimension"] = uint32_t{2250};
    });
    EXPECT_EQ(tags.original_width, 0) << width;
    EXPECT_EQ(tags.original_height, 0) << width;
  }
}

TEST(Exif, ZerosThatNoCameraHasCountAsMissing) {
  const PhotoTags tags = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData& xmp) {
    exif["Exif.Photo.FocalLength"] = "0/1";
    exif["Exif.Photo.FocalLengthIn35mmFilm"] = static_cast<uint16_t>(0);
    exif["Exif.Photo.ExposureTime"] = "0/1";
    exif["Exif.Photo.ShutterSpeedValue"] = "0/1";
    exif["Exif.Photo.FNumber"] = "0/1";
    exif["Exif.Photo.ApertureValue"] = "0/1";
    exif["Exif.Photo.ISOSpeedRatings"] = static_cast<uint16_t>(0);
    xmp["Xmp.drone-dji.GpsLatitude"] = "0.000000000";
    xmp["Xmp.drone-dji.GpsLongitude"] = "0.000000000";
    xmp["Xmp.drone-dji.RtkStdLon"] = "0.00000";
    xmp["Xmp.drone-dji.RtkStdHgt"] = "0.00000";
  });
  EXPECT_FALSE(tags.focal_length_mm || tags.focal_length_35mm || tags.gps);
  EXPECT_FALSE(tags.exposure.time_s || tags.exposure.f_number || tags.exposure.iso);
  EXPECT_FALSE(tags.horizontal_accuracy_m || tags.vertical_accuracy_m);
  // Every drone without RTK has zeros in its tags.
  EXPECT_EQ(tags.zero_tags,
            (std::vector<std::string>{"GPSLatitude and GPSLongitude", "ExposureTime", "FNumber", "ISO", "FocalLength", "FocalLengthIn35mmFilm"}));
}

TEST(Exif, ApexZerosAloneAreValues) {
  const PhotoTags tags = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData&) {
    exif["Exif.Photo.ShutterSpeedValue"] = "0/1";
    exif["Exif.Photo.ApertureValue"] = "0/1";
  });
  EXPECT_EQ(tags.exposure.time_s, 1.0);
  EXPECT_EQ(tags.exposure.f_number, 1.0);
  EXPECT_TRUE(tags.zero_tags.empty());
}

TEST(Exif, AnAbsoluteAltitudeOfZeroGoesBehindAnotherOneUnlessBothAreNearZero) {
  const auto read = [](const char* in_exif) {
    return ReadForged([&](Exiv2::ExifData& exif, Exiv2::XmpData& xmp) {
      SetExifPosition(exif);
      exif["Exif.GPSInfo.GPSAltitude"] = in_exif;
      xmp["Xmp.drone-dji.AbsoluteAltitude"] = "+0.00";
    });
  };
  EXPECT_EQ(read("4562/10").gps->height_m, 456.2);
  EXPECT_EQ(read("3/10").gps->height_m, 0.0);
}

TEST(Exif, OrientationIsReadAndKept) {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    PhotoTags tags;
    tags.orientation = orientation;
    EXPECT_EQ(RoundTrip(tags).orientation, orientation);
  }
  const PhotoTags unknown = ReadForged([](Exiv2::ExifData& exif, Exiv2::XmpData&) { exif["Exif.Image.Orientation"] = static_cast<uint16_t>(9); });
  EXPECT_EQ(unknown.orientation, 1);
}

TEST(Exif, FocalLengthsThatNoLensHasCountAsMissing) {
  const auto focal = [](int mm) {
    const auto set = [mm](Exiv2::ExifData& exif, Exiv2::XmpData&) { exif["Exif.Photo.FocalLengthIn35mmFilm"] = static_cast<uint16_t>(mm); };
    return ReadForged(set).focal_length_35mm;
  };
  for (const int mm : {0, 1, 4, 1501, 65535}) EXPECT_FALSE(focal(mm)) << mm;
  for (const int mm : {5, 24, 1500}) EXPECT_EQ(focal(mm), std::optional<double>(mm));
}

TEST(Exif, NamesOfBandsAreRead) {
  Exiv2::XmpProperties::registerNs("http://pix4d.com/camera/1.0/", "Camera");
  const PhotoTags tags = ReadForged([](Exiv2::ExifData&, Exiv2::XmpData& xmp) {
    Exiv2::XmpArrayValue names(Exiv2::xmpSeq);
    for (const char* name : {"Blue", "Green", "Red edge"}) names.read(name);
    xmp.add(Exiv2::XmpKey("Xmp.Camera.BandName"), &names);
  });
  EXPECT_EQ(tags.band_names, (std::vector<std::string>{"Blue", "Green", "Red edge"}));
  EXPECT_TRUE(ReadForged([](Exiv2::ExifData&, Exiv2::XmpData&) {}).band_names.empty());
}

}  // namespace
}  // namespace skyquilt::survey
