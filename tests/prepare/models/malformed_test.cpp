// Faults that exports have: each error names file and line, what was found and how to fix it.
#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "prepare/models/read_model.h"
#include "tests/prepare/models/made_models.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::models {
namespace {

struct Fault {
  const char* file;  // of the model, which is changed
  const char* from;  // its first occurrence is replaced; empty: the whole content
  const char* to;
  const char* found;  // in the message
  const char* fix;    // in the message
};

// Changes one file of a good model and returns the message.
std::string MessageOf(const test::Files& good, const Fault& fault, const std::string& path) {
  const TemporaryFolder folder;
  test::Files files = good;
  std::string& text = files.at(fault.file);
  if (*fault.from == '\0') {
    text = fault.to;
  } else {
    const size_t at = text.find(fault.from);
    EXPECT_NE(at, std::string::npos) << fault.from;
    if (at != std::string::npos) text.replace(at, std::string(fault.from).size(), fault.to);
  }
  test::WriteFiles(files, folder.path());
  std::vector<std::string> names;
  for (const test::MadePhoto& photo : test::MakeModel().photos) names.push_back(photo.name);
  return InputErrorOf([&] { ReadModel(folder / path, ModelPhotos(folder.path(), names)); });
}

void ExpectMessages(const test::Files& good, const std::string& path, const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) {
    const std::string message = MessageOf(good, fault, path);
    EXPECT_NE(message.find(fault.file), std::string::npos) << fault.to << ": " << message;
    EXPECT_NE(message.find("line "), std::string::npos) << fault.to << ": " << message;
    EXPECT_NE(message.find(fault.found), std::string::npos) << fault.to << ": " << message;
    EXPECT_NE(message.find(fault.fix), std::string::npos) << fault.to << ": " << message;
  }
}

TEST(MalformedModel, Transforms) {
  ExpectMessages(test::TransformsFiles(test::MakeModel()), "transforms.json",
                 {{"transforms.json", "\"frames\"", "\"frames\" 1", "is not JSON", "Give a COLMAP folder"},
                  {"transforms.json", "\"fl_x\"", "\"focal\"", "has neither fl_x nor camera_angle_x", "Export the cameras again"},
                  {"transforms.json", "510.0", "\"long\"", "fl_x must be a number", "Export the cameras again"},
                  {"transforms.json", "510.0", "-510.0", "fl_x must be more than 0", "Export the cameras again"},
                  {"transforms.json", "\"h\": 480", "\"h\": 480.5", "h must be a whole number of pixels", "Export the cameras again"},
                  {"transforms.json", "\"OPENCV\"", "\"EQUIRECTANGULAR\"", "is EQUIRECTANGULAR", "Undistort the photos"},
                  {"transforms.json", "\"k3\"", "\"k4\"", "has k4", "Undistort the photos"},
                  {"transforms.json", "\"transform_matrix\"", "\"matrix\"", "has no \"transform_matrix\"", "Export the cameras again"},
                  {"transforms.json", "DJI_0002", "DJI_0001", "second one for the photo", "Name every photo once"},
                  {"points.ply", "property float z", "property float w", "no element vertex with x, y and z", "Export the points again"},
                  {"points.ply", "vertex 6", "vertex 7", "ends too early", "Export the points again"}});
}

TEST(MalformedModel, TheLineIsThatOfTheValue) {
  const Fault fault{"transforms.json", "", "{\"fl_x\": 500, \"w\": 4, \"h\": 3,\n \"frames\": [\n  {\"file_path\": 7}]}", "", ""};
  const std::string message = MessageOf(test::TransformsFiles(test::MakeModel()), fault, "transforms.json");
  EXPECT_NE(message.find("line 3: frames[0].file_path must be a text, not 7"), std::string::npos) << message;
}

// Python writes NaN and Infinity, which are not JSON.
TEST(MalformedModel, NumbersThatAreNoneAreNamedByTheirPath) {
  const auto message = [](const test::Files& files, const char* path, const char* file, const char* from, const char* to) {
    return MessageOf(files, {file, from, to, "", ""}, path);
  };
  const test::Files transforms = test::TransformsFiles(test::MakeModel());
  for (const char* number : {"NaN", "Infinity", "-Infinity"}) {
    const std::string found = message(transforms, "transforms.json", "transforms.json", "510.0", number);
    EXPECT_NE(found.find("fl_x must be a number from -1e9 to 1e9, not " + std::string(number)), std::string::npos) << found;
    EXPECT_NE(found.find("transforms.json: line "), std::string::npos) << found;
  }
  const std::string in_list = message(transforms, "transforms.json", "transforms.json", "",
                                      "{\"fl_x\": 500, \"w\": 4, \"h\": 3, \"frames\": [{\"file_path\": \"NaN.jpg\",\n"
                                      "\"transform_matrix\": [[1, 0, 0, 0], [0, 1, 0, NaN], [0, 0, 1, 0]]}]}");
  EXPECT_NE(in_list.find("line 2: frames[0].transform_matrix[1][3] must be a number from -1e9 to 1e9, not NaN"), std::string::npos) << in_list;
  const std::string missing = message(transforms, "transforms.json", "transforms.json", "",
                                      "{\"fl_x\": 500, \"w\": 4, \"h\": 3, \"frames\": [{\"file_path\": \"a.jpg\",\n"
                                      "\"transform_matrix\": [[1, 0, 0, 0], [0, 1, 0, null], [0, 0, 1, 0]]}]}");
  EXPECT_NE(missing.find("frames[0].transform_matrix[1][3] must be a number from -1e9 to 1e9, not null"), std::string::npos) << missing;
  const test::Files opensfm = test::OpensfmFiles(test::MakeModel());
  const std::string place = message(opensfm, "reconstruction.json", "reference_lla.json", "47.1", "NaN");
  EXPECT_NE(place.find("latitude must be a number from -1e9 to 1e9, not NaN"), std::string::npos) << place;
  // Still not JSON.
  EXPECT_NE(message(transforms, "transforms.json", "transforms.json", "510.0", "NaNs").find("is not JSON"), std::string::npos);
}

TEST(MalformedModel, Opensfm) {
  ExpectMessages(test::OpensfmFiles(test::MakeModel()), "reconstruction.json",
                 {{"reconstruction.json", "", "[]", "has no reconstruction", "Run OpenSfM"},
                  {"reconstruction.json", "", "[{\"shots\": {\"a\": {}}, \"cameras\": {}}", "is not JSON: the file ends too early", "Run OpenSfM"},
                  {"reconstruction.json", "\"brown\"", "\"spherical\"", "is spherical", "camera_projection_type BROWN"},
                  {"reconstruction.json", "\"rotation\"", "\"turn\"", "has no \"rotation\"", "Run OpenSfM"},
                  {"reconstruction.json", "\"camera\": \"v2 made\"", "\"camera\": \"v3\"", "has no \"v3\"", "Run OpenSfM"},
                  {"reconstruction.json", "\"focal_x\"", "\"focal\"", "has no \"focal_x\"", "Run OpenSfM"},
                  {"reference_lla.json", "47.1", "147.1", "is not a latitude", "Run OpenSfM"},
                  {"tracks.csv", "\t0\t7\t0.1\t0.2\t0.001\t10\t20\t30\t-1\t-1", " 0", "separated by tabs", "create_tracks"}});
}

TEST(MalformedModel, Metashape) {
  ExpectMessages(test::MetashapeFiles(test::MakeModel()), "cameras.xml",
                 {{"cameras.xml", "</sensors>", "</sensor>", "is not XML", "Export Cameras"},
                  {"cameras.xml", "<f>500</f>", "<f>wide</f>", "<f> must have 1 number", "Export Cameras"},
                  {"cameras.xml", "<k3>", "<b2>3</b2>\n<k3>", "has b2, the skew of the axes", "Export undistorted photos"},
                  {"cameras.xml", "<k3>", "<k4>0.1</k4>\n<k3>", "has k4, radius^8", "Export undistorted photos"},
                  {"cameras.xml", "<calibration type=\"frame\" class=\"adjusted\"", "<calibration type=\"spherical\" class=\"adjusted\"",
                   "is of type 'spherical'", "Export undistorted photos"},
                  {"cameras.xml", "sensor_id=\"0\"", "sensor_id=\"4\"", "there is no such <sensor>", "Export Cameras"}});
}

TEST(MalformedModel, MetashapeWithoutAlignedCameras) {
  const Fault fault{"cameras.xml", "", "<document>\n<chunk>\n<cameras><camera id=\"0\" label=\"a\"/></cameras></chunk></document>", "", ""};
  const std::string message = MessageOf(test::MetashapeFiles(test::MakeModel()), fault, "cameras.xml");
  EXPECT_NE(message.find("no <camera> has a <transform>"), std::string::npos) << message;
  EXPECT_NE(message.find("Align the photos"), std::string::npos) << message;
}

TEST(MalformedModel, Opf) {
  ExpectMessages(
      test::OpfFiles(test::MakeModel()), "project.opf",
      {{"project.opf", "application/opf-project+json", "application/other", "is not application/opf-project+json", "OPF again"},
       {"project.opf", "application/opf-calibrated-cameras+json", "application/opf-gps-bias+json", "have no calibration", "after the calibration"},
       {"calibrated.json", "\"perspective\"", "\"fisheye\"", "is fisheye", "undistorted photos"},
       {"calibrated.json", "\"sensor_id\": 77", "\"sensor_id\": 78", "has a sensor_id that is not among", "OPF again"},
       {"calibrated.json", "\"id\": 9843086184167632639", "\"id\": 5", "not in the camera list", "OPF again"},
       {"calibrated.json", "\"id\": 77", "\"id\": 76", "not among the sensors of the input", "OPF again"},
       {"frame.json", "\"swap_xy\": false", "\"swap_xy\": 0", "swap_xy must be true or false", "OPF again"},
       {"tracks.gltf", "\"VEC3\"", "\"VEC2\"", "must be VEC3", "OPF again"},
       {"tracks.gltf", "\"count\": 6", "\"count\": 60000", "has more entries than its buffer view", "OPF again"}});
}

TEST(MalformedModel, PathsThatHoldNoModel) {
  const TemporaryFolder folder;
  const auto message_of = [&](const std::string& name) { return InputErrorOf([&] { FindModel(folder / name); }); };
  EXPECT_NE(message_of("missing").find("no such folder or file"), std::string::npos);
  EXPECT_NE(message_of("").find("has no camera model that is known"), std::string::npos);
  test::WriteFiles(
      {{"a.json", "{\"version\": 1}"}, {"b.json", "{\"format\": \"application/opf-camera-list+json\"}"}, {"c.xml", "<html/>"}, {"d.dat", "x"}},
      folder.path());
  EXPECT_NE(message_of("a.json").find("holds no cameras"), std::string::npos);
  EXPECT_NE(message_of("b.json").find("Give the project file, which ends in .opf"), std::string::npos);
  EXPECT_NE(message_of("c.xml").find("is not an XML file of Metashape"), std::string::npos);
  EXPECT_NE(message_of("d.dat").find("Give a COLMAP folder"), std::string::npos);
  test::WriteFiles({{"a.opf", "{}"}, {"b.opf", "{}"}}, folder.path());
  EXPECT_NE(message_of("").find("has several camera models: a.opf, b.opf"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::prepare::models
