// Tests the architecture: compares every #include line of the program with the allowed dependencies between its folders ("rooms"), and lets each
// third-party library be used by one room only.
#include <gtest/gtest.h>

#include <algorithm>
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

using Arrows = std::map<std::string, std::set<std::string>>;

// Every room, with the other rooms that it may include. "core" means all rooms of core.
const Arrows& AllowedIncludes() {
  static const Arrows allowed = [] {
    Arrows arrows = {
        {"app",
         {"bench", "viewer", "odm", "coordinator", "simulate", "prepare", "masks", "partition", "worker", "merge", "products", "surface", "buildings",
          "tour", "evaluate", "core"}},
        // Of app only settings/, which says what options a person chose.
        {"python",
         {"app", "coordinator", "simulate", "prepare", "masks", "partition", "worker", "merge", "products", "surface", "buildings", "evaluate",
          "core"}},
        {"bench", {"coordinator", "simulate", "prepare", "partition", "worker", "merge", "products", "surface", "buildings", "evaluate", "core"}},
        {"viewer", {"coordinator", "prepare", "partition", "products", "surface", "buildings", "tour", "core"}},
        {"coordinator",
         {"simulate", "prepare", "masks", "partition", "worker", "merge", "products", "surface", "buildings", "tour", "evaluate", "core"}},
        {"odm", {"coordinator", "prepare", "surface", "core"}},
        {"buildings", {"surface", "core"}},
        {"tour", {"products", "surface", "core"}},
        {"evaluate", {"partition", "surface", "buildings", "core"}},
        {"core/geo", {"core/linear", "core/base"}},
        {"core/camera", {"core/geo", "core/linear", "core/base"}},
        {"core/survey", {"core/camera", "core/image", "core/geo", "core/config", "core/base"}},
        {"core/encoding", {"core/kernel", "core/base"}},
        {"core/field", {"core/encoding", "core/kernel", "core/base"}},
        {"core/brightness", {"core/survey", "core/image", "core/config", "core/checkpoint", "core/base"}},
        {"core/render", {"core/field", "core/encoding", "core/kernel", "core/brightness", "core/geo", "core/image", "core/base"}},
        {"core/scene",
         {"core/render", "core/field", "core/encoding", "core/brightness", "core/camera", "core/geo", "core/linear", "core/checkpoint", "core/image",
          "core/base"}},
        {"core/trust", {"core/render", "core/config", "core/checkpoint", "core/image", "core/linear", "core/base"}},
        {"core/metrics", {"core/network", "core/image", "core/base"}},
        {"core/gis", {"core/geo", "core/image", "core/base"}},
    };
    for (const char* room : {"base", "linear"}) arrows[std::string("core/") + room] = {};
    for (const char* room : {"config", "checkpoint", "comm", "image", "kernel", "network", "raytrace", "page"})
      arrows[std::string("core/") + room] = {"core/base"};
    for (const char* room : {"simulate", "prepare", "masks", "partition", "worker", "merge", "products", "surface"}) arrows[room] = {"core"};
    return arrows;
  }();
  return allowed;
}

// The folders of a room that are rooms, too.
struct InnerRoom {
  Arrows arrows;                 // per folder, the other folders that it may include
  std::set<std::string> shared;  // files above the folders that these may include; they know no other of them
};

const std::map<std::string, InnerRoom>& InnerRooms() {
  static const std::map<std::string, InnerRoom> inner = {
      {"prepare",
       {{
            {"tables", {}},
            {"models", {}},
            {"input", {"models", "tables"}},
            {"bundle", {}},
            {"poses", {"input", "bundle"}},
            {"control", {"input", "models", "tables", "bundle"}},
            {"georeference", {"control", "poses", "input", "models", "tables", "bundle"}},
            {"video", {"input", "tables"}},
            {"rigs", {"input", "tables", "poses"}},
        },
        {}}},
      {"evaluate",
       {{
            {"trust", {}},
            {"photos", {"trust"}},
            {"surface", {"photos"}},
            {"buildings", {"surface"}},
            {"control", {"photos"}},
            {"ortho", {"surface"}},
            {"metrics", {"photos", "surface", "buildings", "control", "ortho", "trust"}},
            {"page", {"photos", "surface", "buildings", "control", "ortho", "metrics", "trust"}},
        },
        {"evaluate/evaluate_input.h", "evaluate/evaluate_options.h", "evaluate/json_members.h", "evaluate/measured.h"}}},
  };
  return inner;
}

struct Library {
  std::string name;
  std::regex header;
  std::set<std::string> rooms;       // the only ones that may include it
  std::vector<std::string> headers;  // some of its headers
};

const std::vector<Library>& Libraries() {
  static const std::vector<Library> libraries = {
      {"Eigen's decompositions, which take long to compile,",
       std::regex("Eigen/(Cholesky|Dense|Eigenvalues|LU|QR|SVD|Sparse.*)"),
       {"core/linear"},
       {"Eigen/Dense", "Eigen/SVD", "Eigen/QR"}},
      {"MPI", std::regex("(.*/)?mpi\\.h"), {"core/comm"}, {"mpi.h"}},
      {"HDF5", std::regex("(.*/)?(hdf5(_hl)?\\.h|H5[^/]*\\.h|highfive/.*)"), {"core/checkpoint"}, {"hdf5.h", "hdf5/serial/H5Cpp.h"}},
      {"GeographicLib", std::regex("GeographicLib/.*"), {"core/geo"}, {"GeographicLib/UTMUPS.hpp"}},
      {"PROJ", std::regex("proj(_[^/]*)?\\.h"), {"core/geo"}, {"proj.h"}},
      {"pugixml", std::regex("pugixml\\.hpp"), {"prepare"}, {"pugixml.hpp"}},
      {"Highway", std::regex("hwy/.*"), {"core/kernel"}, {"hwy/highway.h", "hwy/foreach_target.h"}},
      {"OpenCV image I/O",
       std::regex("opencv2/(imgcodecs|highgui)(\\.hpp|/.*)|opencv2/opencv\\.hpp"),
       {"core/image"},
       {"opencv2/imgcodecs.hpp", "opencv2/opencv.hpp"}},
      {"libheif", std::regex("libheif/.*"), {"core/image"}, {"libheif/heif.h"}},
      {"LibRaw", std::regex("libraw/.*"), {"core/image"}, {"libraw/libraw.h"}},
      {"OpenCV's networks", std::regex("opencv2/dnn(\\.hpp|/.*)"), {"core/network"}, {"opencv2/dnn.hpp"}},
      {"Exiv2", std::regex("exiv2/.*"), {"core/survey"}, {"exiv2/exiv2.hpp"}},
      {"Embree", std::regex("embree[0-9]*/.*"), {"core/raytrace"}, {"embree3/rtcore.h"}},
      {"GDAL", std::regex("(gdal/)?(gdal|ogr_|ogrsf|cpl_|vrt)[^/]*\\.h"), {"core/gis"}, {"gdal_priv.h", "gdal/ogr_spatialref.h"}},
      {"Boost", std::regex("boost/.*"), {"viewer", "buildings"}, {"boost/asio.hpp"}},
      {"Ceres", std::regex("ceres/.*"), {"prepare", "buildings"}, {"ceres/ceres.h"}},
      {"SQLite", std::regex("sqlite3(ext)?\\.h"), {"core/survey"}, {"sqlite3.h"}},
      {"zlib", std::regex("zlib\\.h"), {"core/base"}, {"zlib.h"}},
      {"pybind11", std::regex("pybind11/.*|Python\\.h|numpy/.*"), {"python"}, {"pybind11/pybind11.h", "pybind11/stl.h"}},
      {"toml++", std::regex("toml\\+\\+/.*|toml\\.hpp"), {"core/config"}, {"toml++/toml.h"}},
  };
  return libraries;
}

// The first folder of a path, in core the first two: "core/geo", "simulate".
std::string RoomOf(const std::string& path) {
  const size_t first = path.find('/');
  if (first == std::string::npos) return "";
  return path.substr(0, path.starts_with("core/") ? path.find('/', first + 1) : first);
}

// The folder of a path inside of its room, as in InnerRooms: "poses" of "prepare/poses/seed/verdict.h"; empty for files above the folders.
std::string InnerRoomOf(const std::string& path) {
  const size_t first = RoomOf(path).size() + 1, end = path.find('/', first);
  return end == std::string::npos ? "" : path.substr(first, end - first);
}

// Why a file may not include a header of its own room; empty when it may.
std::string InnerViolation(const std::string& file, const std::string& header) {
  const auto inner = InnerRooms().find(RoomOf(file));
  if (inner == InnerRooms().end()) return "";
  const std::string from = InnerRoomOf(file), to = InnerRoomOf(header);
  if (from.empty() || from == to || inner->second.shared.contains(header)) return "";
  const auto allowed = inner->second.arrows.find(from);
  if (allowed == inner->second.arrows.end()) return from + " is not a folder of InnerRooms";
  if (allowed->second.contains(to)) return "";
  return inner->first + "/" + from + " may not include " + (to.empty() ? "what lies above it" : inner->first + "/" + to);
}

bool IsOurs(const std::string& folder) {
  return std::any_of(AllowedIncludes().begin(), AllowedIncludes().end(),
                     [&](const auto& room) { return room.first == folder || room.first.starts_with(folder + "/"); });
}

// Why `file` may not include `header`; empty when it may.
std::string Violation(const std::string& file, const std::string& header) {
  const std::string room = RoomOf(file);
  for (const Library& library : Libraries()) {
    if (std::regex_match(header, library.header) && !library.rooms.contains(room)) return library.name + " belongs to " + *library.rooms.begin();
  }
  if (header.find("..") != std::string::npos) return "relative path";
  if (!IsOurs(header.substr(0, header.find('/')))) return "";
  const auto allowed = AllowedIncludes().find(room);
  if (allowed == AllowedIncludes().end()) return room + " is not a room of AllowedIncludes";
  const std::string other = RoomOf(header);
  if (other == room) return InnerViolation(file, header);
  if (room == "python" && other == "app" && !header.starts_with("app/settings/")) return "python may include only app/settings";
  if (allowed->second.contains(other)) return "";
  if (other.starts_with("core/") && allowed->second.contains("core") && AllowedIncludes().contains(other)) return "";
  return room + " may not include " + other;
}

// "file:line: include (violation)" for every forbidden include line of a source.
std::vector<std::string> Violations(const std::string& file, const std::vector<std::string>& lines) {
  static const std::regex include_line("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"].*");
  std::vector<std::string> violations;
  int number = 0;
  for (const std::string& line : lines) {
    ++number;
    std::smatch match;
    if (line.find("include") == std::string::npos || !std::regex_match(line, match, include_line)) continue;
    const std::string violation = Violation(file, match[1]);
    if (violation.empty()) continue;
    std::ostringstream message;
    message << file << ":" << number << ": " << match[1] << " (" << violation << ")";
    violations.push_back(message.str());
  }
  return violations;
}

std::vector<std::string> ViolationsIn(const std::string& file, const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return Violations(file, lines);
}

struct Source {
  std::string file;  // relative to the source folder
  std::vector<std::string> lines;
};

// The source files of all rooms.
const std::vector<Source>& Sources() {
  static const std::set<std::string> kExtensions = {".h", ".hpp", ".cpp", ".cc", ".cu", ".inl"};
  static const std::vector<Source> sources = [] {
    const fs::path folder = SKYQUILT_SOURCE_DIR;
    std::vector<Source> found;
    for (const auto& [room, ignored] : AllowedIncludes()) {
      for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / room)) {
        if (!entry.is_regular_file() || !kExtensions.contains(entry.path().extension().string())) continue;
        Source& source = found.emplace_back();
        source.file = fs::relative(entry.path(), folder).generic_string();
        std::ifstream in(entry.path());
        for (std::string line; std::getline(in, line);) source.lines.push_back(line);
      }
    }
    return found;
  }();
  return sources;
}

// The lines of each file, without comments, that match. Regular expressions are slow: only lines with one of these words are searched.
std::map<std::string, std::string> FilesWith(const std::vector<std::string>& words, const std::regex& pattern) {
  std::map<std::string, std::string> found;
  for (const auto& [file, lines] : Sources()) {
    for (std::string line : lines) {
      line.resize(std::min(line.size(), line.find("//")));
      const bool has_word = std::any_of(words.begin(), words.end(), [&](const std::string& word) { return line.find(word) != std::string::npos; });
      if (has_word && std::regex_search(line, pattern)) found[file] += line + "\n";
    }
  }
  return found;
}

// Removes rooms that include none of those left, until none is left.
void ExpectNoCycle(Arrows left) {
  while (!left.empty()) {
    const auto end = std::find_if(left.begin(), left.end(), [](const auto& room) { return room.second.empty(); });
    ASSERT_NE(end, left.end()) << "a cycle with " << left.begin()->first;
    const std::string room = end->first;
    left.erase(end);
    for (auto& [other, others] : left) others.erase(room);
  }
}

TEST(Rooms, HaveNoCyclicIncludes) {
  Arrows rooms = AllowedIncludes();
  for (auto& [room, others] : rooms) {
    if (others.erase("core") == 0) continue;
    for (const auto& [other, ignored] : AllowedIncludes()) {
      if (other.starts_with("core/")) others.insert(other);
    }
  }
  ExpectNoCycle(rooms);
}

TEST(Rooms, EveryFolderWithCodeIsOne) {
  const fs::path source = SKYQUILT_SOURCE_DIR;
  for (const char* parent : {".", "core"}) {
    for (const fs::directory_entry& entry : fs::directory_iterator(source / parent)) {
      const std::string folder = fs::relative(entry.path(), source).generic_string();
      if (!entry.is_directory() || folder == "core" || folder == "tests" || !fs::exists(entry.path() / "CMakeLists.txt")) continue;
      EXPECT_TRUE(AllowedIncludes().contains(folder)) << folder << " is missing in AllowedIncludes";
    }
  }
}

TEST(Rooms, NamespacesAreNamedAfterThem) {
  static const std::regex kNamespace("^namespace skyquilt::(\\w+).*");
  size_t n_named = 0;
  for (const auto& [file, lines] : Sources()) {
    const std::string room = RoomOf(file);
    const std::string name = room.substr(room.find('/') + 1);
    for (const std::string& line : lines) {
      std::smatch match;
      if (!line.starts_with("namespace skyquilt::") || !std::regex_match(line, match, kNamespace)) continue;
      ++n_named;
      EXPECT_EQ(match[1], name) << file;
    }
  }
  EXPECT_GT(n_named, 100U);
}

TEST(Rooms, IncludeOnlyWhatIsAllowed) {
  std::string report;
  for (const auto& [file, lines] : Sources()) {
    for (const std::string& line : Violations(file, lines)) report += line + "\n";
  }
  EXPECT_GT(Sources().size(), 20U) << "hardly any source found under " << SKYQUILT_SOURCE_DIR;
  EXPECT_EQ(report, "");
}

TEST(InnerRooms, HaveNoCyclicIncludes) {
  for (const auto& [room, inner] : InnerRooms()) ExpectNoCycle(inner.arrows);
}

TEST(InnerRooms, EveryFolderWithCodeIsOne) {
  for (const auto& [room, inner] : InnerRooms()) {
    std::set<std::string> found;
    for (const auto& [file, lines] : Sources()) {
      if (RoomOf(file) == room && !InnerRoomOf(file).empty()) found.insert(InnerRoomOf(file));
    }
    std::set<std::string> named;
    for (const auto& [folder, ignored] : inner.arrows) named.insert(folder);
    EXPECT_EQ(found, named) << room;
  }
}

TEST(InnerRooms, NamespacesAreNamedAfterThem) {
  for (const auto& [file, lines] : Sources()) {
    if (!InnerRooms().contains(RoomOf(file))) continue;
    const std::string folder = InnerRoomOf(file);
    const std::string name = "namespace skyquilt::" + RoomOf(file) + (folder.empty() ? "" : "::" + folder);
    for (const std::string& line : lines) {
      // By the ends, because a type of another folder may be declared in a line.
      if (line.starts_with("}  // namespace skyquilt")) EXPECT_EQ(line, "}  // " + name) << file;
    }
  }
}

// Scores against kept points mean nothing when anything that leads to a scene has seen them.
TEST(Rooms, ThoseThatLeadToASceneDoNotReadKeptPoints) {
  static const std::set<std::string> kMayRead = {"app", "bench", "coordinator", "prepare", "evaluate", "core/survey"};
  std::set<std::string> readers;
  for (const auto& [file, lines] : FilesWith({"kept_"}, std::regex("^[^/]*(kept_points|kept_tracks).*"))) {
    readers.insert(RoomOf(file));
    EXPECT_TRUE(kMayRead.contains(RoomOf(file))) << file << ": " << lines;
    EXPECT_FALSE(file.starts_with("coordinator/scheduler")) << file << ": " << lines;
  }
  EXPECT_TRUE(readers.contains("prepare") && readers.contains("evaluate"));
}

// Eigen/Geometry makes them visible too, and each use of one costs its file seconds of compilation.
TEST(Rooms, EigensDecompositionsAreUsedInOneRoom) {
  static const std::regex kDecomposition(
      "Eigen::(SelfAdjointEigenSolver|EigenSolver|JacobiSVD|BDCSVD|LLT|LDLT|PartialPivLU|FullPivLU|[A-Za-z]*HouseholderQR|Simplicial[A-Z]+|umeyama|"
      "Quaterniond::FromTwoVectors)"
      "\\b"
      "|[.](ldlt|llt|lu|partialPivLu|fullPivLu|jacobiSvd|bdcSvd|householderQr|colPivHouseholderQr|fullPivHouseholderQr)[(][)]");
  bool in_linear = false;
  for (const auto& [file, lines] : FilesWith({"Eigen::", "ldlt", "llt", "Lu()", "lu()", "Svd()", "Qr()"}, kDecomposition)) {
    in_linear = in_linear || RoomOf(file) == "core/linear";
    EXPECT_EQ(RoomOf(file), "core/linear") << file << ": " << lines << "use core/linear, or add there what is missing";
  }
  EXPECT_TRUE(in_linear);
}

// The same holds for regular expressions, for JSON's parser and writer, and for spdlog.
TEST(Rooms, CostlyTemplatesAreUsedInOneFile) {
  static const std::regex kCostly("std::(regex|smatch|sregex_iterator)\\b|\\b(ordered_)?json::parse[(]|[.]dump[(]|<spdlog/");
  static const std::set<std::string> kMay = {"core/base/pattern.cpp", "core/base/json_text.cpp", "core/base/log.cpp", "core/base/checked_json.cpp"};
  std::set<std::string> users;
  for (const auto& [file, lines] : FilesWith({"regex", "std::smatch", "json::parse", ".dump(", "<spdlog/"}, kCostly)) {
    users.insert(file);
    EXPECT_TRUE(kMay.contains(file)) << file << ": " << lines << "use core/base/pattern.h, core/base/json_text.h or core/base/log.h";
  }
  EXPECT_EQ(users, kMay) << "files that need no exception any more";
}

// The Python module is a shared library of code for programs (cmake/SkyquiltPython.cmake), in which thread-local variables do not fit: its linker
// would refuse them with "unsupported reloc". What a thread needs of its own goes into a list by the thread's number, which base::ThreadPool gives.
TEST(Rooms, OfThePythonModuleHaveNoThreadLocalVariables) {
  static const std::set<std::string> kNotInside = {"app", "bench", "odm", "viewer"};
  for (const auto& [file, lines] : FilesWith({"thread_local"}, std::regex("\\bthread_local\\b"))) {
    EXPECT_TRUE(kNotInside.contains(RoomOf(file))) << file << ": " << lines;
  }
}

// So that one place decides what is synced, and what a message says, when a file gets its name.
TEST(Rooms, FilesAreRenamedInOneFile) {
  std::set<std::string> users;
  for (const auto& [file, lines] : FilesWith({"rename("}, std::regex("\\brename[(]"))) users.insert(file);
  EXPECT_EQ(users, std::set<std::string>({"core/base/file.cpp"})) << "use Rename or Publish of core/base/file.h, or PartialPath";
}

TEST(Libraries, BelongToTheirRooms) {
  for (const Library& library : Libraries()) {
    for (const auto& [room, ignored] : AllowedIncludes()) {
      for (const std::string& header : library.headers) {
        const bool allowed = library.rooms.contains(room);
        EXPECT_EQ(ViolationsIn(room + "/a.cpp", "#include <" + header + ">\n").empty(), allowed) << room << ": " << header;
      }
    }
  }
}

using Includes = std::vector<std::pair<std::string, std::vector<std::string>>>;  // per file, its headers

TEST(Rooms, ForbiddenIncludesAreFound) {
  const Includes forbidden = {
      {"core/encoding/hash.cpp", {"hwy/highway.h"}},
      {"core/render/a.h", {"worker/trainer.h", "core/scene/scene.h", "core/checkpoint/archive.h"}},
      {"core/base/a.h", {"partition/block.h", "core/geo/utm.h"}},
      {"core/geo/a.cpp", {"core/camera/camera.h"}},
      {"core/field/a.cpp", {"core/image/image.h"}},
      {"core/kernel/deep/a.cpp", {"core/encoding/hash.h"}},
      {"core/camera/a.cpp", {"../render/scene.h"}},
      {"core/extra/a.cpp", {"core/base/errors.h"}},
      {"worker/a.cpp", {"partition/block.h", "coordinator/project/project.h", "core/nowhere/a.h"}},
      {"evaluate/a.cpp", {"worker/trainer.h"}},
      {"merge/a.cpp", {"partition/block.h"}},
      {"prepare/a.cpp", {"simulate/world.h"}},
      {"partition/a.cpp", {"worker/trainer.h"}},
      {"coordinator/stages/a.cpp", {"bench/bench_page.h", "viewer/tour_parts.h"}},
      {"bench/a.cpp", {"app/commands/cli.h"}},
      {"python/a.cpp", {"app/commands/command.h", "viewer/tour_parts.h", "tour/format/tour.h", "bench/bench_page.h"}},
      {"app/commands/a.cpp", {"python/open_scene.h"}},
      {"surface/mesh/a.cpp", {"products/map_rays.h"}},
      {"tour/format/a.cpp", {"viewer/data/project_data.h"}},
      {"evaluate/photos/a.cpp", {"evaluate/metrics/metrics.h"}},
      {"evaluate/surface/a.h", {"evaluate/evaluate.h"}},
      {"evaluate/buildings/a.cpp", {"evaluate/page/page_parts.h", "evaluate/control/control_summary.h"}},
      {"evaluate/nowhere/a.cpp", {"evaluate/photos/coverage.h"}},
      {"prepare/bundle/a.cpp", {"prepare/control/fit/fit_control.h"}},
      {"prepare/poses/seed/a.h", {"prepare/georeference/gravity.h"}},
      {"prepare/control/fit/a.cpp", {"prepare/prepare_options.h"}},
      {"prepare/input/masks/a.cpp", {"prepare/poses/pairs.h"}},
      {"prepare/nowhere/a.cpp", {"prepare/input/prepared_photo.h"}},
  };
  for (const auto& [file, headers] : forbidden) {
    for (const std::string& header : headers) {
      const std::vector<std::string> found = ViolationsIn(file, "#include <vector>\n  #  include \"" + header + "\"  // why\nint x;\n");
      ASSERT_EQ(found.size(), 1U) << file << ": " << header;
      EXPECT_TRUE(found[0].starts_with(file + ":2: ")) << found[0];
    }
  }
}

TEST(Rooms, AllowedIncludesAreAccepted) {
  const Includes allowed = {
      {"core/geo/transform.h", {"Eigen/Geometry"}},
      {"core/metrics/ssim.cpp", {"opencv2/imgproc.hpp"}},
      {"core/render/ray_engine.h", {"core/field/field.h"}},
      {"core/survey/survey.h", {"core/camera/camera.h"}},
      {"worker/trainer.h", {"core/scene/scene.h"}},
      {"app/commands/render.cpp", {"products/render_views.h"}},
      {"evaluate/a.cpp", {"partition/block.h", "surface/make_surface.h", "evaluate/page/report_writer.h"}},
      {"evaluate/surface/a.cpp", {"evaluate/photos/coverage.h", "evaluate/measured.h"}},
      {"evaluate/page/a.cpp", {"evaluate/metrics/metrics.h"}},
      {"evaluate/photos/a.cpp", {"evaluate/evaluate_input.h"}},
      {"bench/a.cpp", {"evaluate/surface/true_surface.h"}},
      {"tour/export/a.cpp", {"products/ray_caster.h"}},
      {"viewer/data/a.cpp", {"tour/format/read_tour.h"}},
      {"prepare/a.cpp", {"prepare/control/fit/fit_control.h"}},
      {"prepare/poses/a.cpp", {"prepare/poses/seed/verdict.h"}},
      {"prepare/georeference/tags/a.cpp", {"prepare/input/prepared_photo.h"}},
      {"prepare/bundle/a.cpp", {"core/linear/linear.h"}},
  };
  for (const auto& [file, headers] : allowed) {
    for (const std::string& header : headers) EXPECT_TRUE(ViolationsIn(file, "#include \"" + header + "\"\n").empty()) << file << ": " << header;
  }
  EXPECT_TRUE(ViolationsIn("core/field/a.cpp", "// #include <mpi.h>\n").empty());
}

}  // namespace
}  // namespace skyquilt
