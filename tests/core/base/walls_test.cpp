// Keeps the rooms apart: reads every #include line of the program and compares it with the plan of the house.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace skyquilt {
namespace {

namespace fs = std::filesystem;

// Rooms of core, each with the rooms of core it may include besides itself.
const std::map<std::string, std::set<std::string>>& CoreArrows() {
  static const std::map<std::string, std::set<std::string>> arrows = {
      {"base", {}},
      {"config", {"base"}},
      {"checkpoint", {"base"}},
      {"comm", {"base"}},
      {"geo", {"base"}},
      {"camera", {"geo", "base"}},
      {"image", {"base"}},
      {"survey", {"camera", "image", "geo", "config", "base"}},
      {"kernel", {"base"}},
      {"encoding", {"kernel", "base"}},
      {"field", {"encoding", "kernel", "base"}},
      {"render", {"field", "encoding", "kernel", "camera", "geo", "checkpoint", "brightness", "image", "base"}},
      {"metrics", {"image", "base"}},
      {"brightness", {"image", "config", "checkpoint", "base"}},
  };
  return arrows;
}

// Which of the four houses may include which.
const std::map<std::string, std::set<std::string>>& HouseArrows() {
  static const std::map<std::string, std::set<std::string>> arrows = {
      {"core", {"core"}},
      {"partition", {"partition", "core"}},
      {"worker", {"worker", "core"}},
      {"coordinator", {"coordinator", "worker", "partition", "core"}},
  };
  return arrows;
}

struct Wall {
  std::string what;
  std::regex header;
  std::string room;
};

const std::vector<Wall>& Walls() {
  static const std::vector<Wall> walls = {
      {"MPI", std::regex("(.*/)?mpi\\.h"), "core/comm"},
      {"HDF5", std::regex("(.*/)?(hdf5(_hl)?\\.h|H5[^/]*\\.h|highfive/.*)"), "core/checkpoint"},
      {"GeographicLib", std::regex("GeographicLib/.*"), "core/geo"},
      {"Highway", std::regex("hwy/.*"), "core/kernel"},
      {"OpenCV image I/O", std::regex("opencv2/(imgcodecs|highgui)(\\.hpp|/.*)|opencv2/opencv\\.hpp"), "core/image"},
      {"Exiv2", std::regex("exiv2/.*"), "core/survey"},
      {"Embree", std::regex("embree[0-9]*/.*"), "coordinator/simulate"},
      {"GDAL", std::regex("(gdal/)?(gdal|ogr_|ogrsf|cpl_|vrt)[^/]*\\.h"), "coordinator/products"},
      {"toml++", std::regex("toml\\+\\+/.*|toml\\.hpp"), "core/config"},
  };
  return walls;
}

// First and, where there are two, second folder of a path: "core/geo", "coordinator/simulate", "worker".
std::string RoomOf(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().generic_string();
  const size_t first = folder.find('/');
  return first == std::string::npos ? folder : folder.substr(0, folder.find('/', first + 1));
}

std::string HouseOf(const std::string& path) {
  return path.substr(0, path.find('/'));
}

// What is wrong with `file` including `header`; empty when nothing is.
std::string Offence(const std::string& file, const std::string& header) {
  const std::string room = RoomOf(file);
  for (const Wall& wall : Walls()) {
    if (std::regex_match(header, wall.header) && room != wall.room) return wall.what + " belongs to " + wall.room;
  }
  if (header.find("..") != std::string::npos) return "relative path";
  const std::string house = HouseOf(header);
  if (!HouseArrows().contains(house)) return "";
  const std::string own_house = HouseOf(file);
  if (!HouseArrows().at(own_house).contains(house)) return own_house + " must not know " + house;
  if (own_house != "core") return "";
  const std::string own_name = room.substr(room.find('/') + 1);
  const std::string header_room = RoomOf(header);
  const std::string header_name = header_room.substr(header_room.find('/') + 1);
  const auto arrows = CoreArrows().find(own_name);
  if (arrows == CoreArrows().end()) return "core/" + own_name + " is not in the plan";
  if (header_name != own_name && !arrows->second.contains(header_name)) return "no arrow from " + own_name + " to " + header_name;
  return "";
}

// "file:line: include (offence)" for every include line of a source text that breaks a wall.
std::vector<std::string> Offences(const std::string& file, std::istream& text) {
  static const std::regex include_line("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"].*");
  std::vector<std::string> offences;
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    ++number;
    std::smatch match;
    if (!std::regex_match(line, match, include_line)) continue;
    const std::string offence = Offence(file, match[1]);
    if (offence.empty()) continue;
    std::ostringstream message;
    message << file << ":" << number << ": " << match[1] << " (" << offence << ")";
    offences.push_back(message.str());
  }
  return offences;
}

std::vector<std::string> OffencesIn(const std::string& file, const std::string& text) {
  std::istringstream in(text);
  return Offences(file, in);
}

TEST(Walls, StandInEveryRoom) {
  const fs::path source = SKYQUILT_SOURCE_DIR;
  const std::set<std::string> extensions = {".h", ".hpp", ".cpp", ".cc", ".cu", ".inl"};
  size_t n_files = 0;
  std::string report;
  for (const auto& [house, ignored] : HouseArrows()) {
    ASSERT_TRUE(fs::is_directory(source / house)) << house;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(source / house)) {
      if (!entry.is_regular_file() || !extensions.contains(entry.path().extension().string())) continue;
      ++n_files;
      std::ifstream in(entry.path());
      ASSERT_TRUE(in.good()) << entry.path();
      for (const std::string& line : Offences(fs::relative(entry.path(), source).generic_string(), in)) report += line + "\n";
    }
  }
  EXPECT_GT(n_files, 20U) << "hardly any source found under " << source;
  EXPECT_EQ(report, "");
}

TEST(Walls, CatchKnownOffences) {
  const std::vector<std::pair<std::string, std::string>> offenders = {
      {"worker/trainer.cpp", "#include <mpi.h>"},
      {"core/checkpoint/writer.cpp", "#include <mpi.h>"},
      {"core/field/save.cpp", "#include <hdf5.h>"},
      {"core/field/save.cpp", "#include <hdf5/serial/H5Cpp.h>"},
      {"coordinator/prepare/a.cpp", "  #  include <GeographicLib/Geocentric.hpp>"},
      {"core/encoding/hash.cpp", "#include \"hwy/highway.h\""},
      {"core/metrics/ssim.cpp", "#include <opencv2/imgcodecs.hpp>"},
      {"coordinator/products/video.cpp", "#include <opencv2/opencv.hpp>"},
      {"coordinator/prepare/a.cpp", "#include <exiv2/exiv2.hpp>"},
      {"core/render/ray.cpp", "#include <embree3/rtcore.h>"},
      {"coordinator/report/a.cpp", "#include <gdal_priv.h>"},
      {"coordinator/report/a.cpp", "#include <gdal/ogr_spatialref.h>"},
      {"worker/a.h", "#include <toml++/toml.h>"},
      {"core/render/a.h", "#include \"worker/trainer.h\""},
      {"core/base/a.h", "#include \"partition/block.h\""},
      {"worker/a.cpp", "#include \"partition/block.h\""},
      {"worker/a.cpp", "#include \"coordinator/pipeline_project.h\""},
      {"partition/a.cpp", "#include \"worker/trainer.h\""},
      {"core/base/a.cpp", "#include \"core/geo/utm.h\""},
      {"core/geo/a.cpp", "#include \"core/camera/camera.h\""},
      {"core/field/a.cpp", "#include \"core/image/image.h\""},
      {"core/kernel/deep/a.cpp", "#include \"core/encoding/hash.h\""},
      {"core/camera/a.cpp", "#include \"../render/scene.h\""},
      {"core/extra/a.cpp", "#include \"core/base/errors.h\""},
  };
  for (const auto& [file, line] : offenders) {
    const std::vector<std::string> found = OffencesIn(file, "#include <vector>\n" + line + "  // why\nint x;\n");
    ASSERT_EQ(found.size(), 1U) << file << ": " << line;
    EXPECT_TRUE(found[0].starts_with(file + ":2: ")) << found[0];
  }
}

TEST(Walls, LetTheOwnersPass) {
  const std::vector<std::pair<std::string, std::string>> owners = {
      {"core/comm/mpi_comm.cpp", "#include <mpi.h>"},
      {"core/checkpoint/file.cpp", "#include <hdf5.h>"},
      {"core/geo/utm.cpp", "#include <GeographicLib/UTMUPS.hpp>"},
      {"core/kernel/adam.cpp", "#include <hwy/foreach_target.h>"},
      {"core/image/decode.cpp", "#include <opencv2/imgcodecs.hpp>"},
      {"core/metrics/ssim.cpp", "#include <opencv2/imgproc.hpp>"},
      {"core/survey/exif.cpp", "#include <exiv2/exiv2.hpp>"},
      {"coordinator/simulate/trace.cpp", "#include <embree3/rtcore.h>"},
      {"coordinator/products/ortho.cpp", "#include <gdal_priv.h>"},
      {"core/config/toml_reader.cpp", "#include <toml++/toml.h>"},
      {"core/render/scene.h", "#include \"core/field/field.h\""},
      {"core/survey/survey.h", "#include \"core/camera/camera.h\""},
      {"worker/trainer.h", "#include \"core/render/scene.h\""},
      {"coordinator/commands/train.cpp", "#include \"worker/trainer.h\""},
      {"core/field/a.cpp", "// #include <mpi.h>"},
  };
  for (const auto& [file, line] : owners) EXPECT_TRUE(OffencesIn(file, line + "\n").empty()) << file << ": " << line;
}

}  // namespace
}  // namespace skyquilt
