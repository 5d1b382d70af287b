// COLMAP models. An input is one file of the model; its first byte says which one. The other files of the model are valid.
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/colmap_model.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::fuzz {
namespace {

const char* const kFiles[] = {"cameras.txt", "images.txt", "points3D.txt", "cameras.bin", "images.bin", "points3D.bin"};

template <typename T>
void Add(std::string* to, T value) {
  to->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

survey::ColmapModel SmallModel() {
  survey::ColmapModel model;
  camera::Camera camera;
  camera.model = camera::CameraModel::kOpencv;
  camera.width = 640;
  camera.height = 480;
  camera.params = {500.0, 500.0, 320.0, 240.0, 0.01, -0.02, 0.001, 0.0};
  model.cameras[1] = camera;
  for (uint32_t i = 1; i <= 3; ++i) {
    survey::ColmapImage image;
    image.id = i;
    image.camera_id = 1;
    image.name = "photo " + std::to_string(i) + ".jpg";
    image.cam_from_world.translation = {1.0 * i, 2.0, 3.0};
    model.images.push_back(image);
  }
  for (uint64_t i = 1; i <= 4; ++i) model.points.push_back({i, Eigen::Vector3d(1.0, 2.0, 0.5), {10, 20, 30}, 0.7, {1, 2, 3}});
  return model;
}

std::string BinaryCameras() {
  std::string bytes;
  Add<uint64_t>(&bytes, 1);
  Add<uint32_t>(&bytes, 1);
  Add<int32_t>(&bytes, 4);  // OPENCV
  Add<uint64_t>(&bytes, 640);
  Add<uint64_t>(&bytes, 480);
  for (const double p : {500.0, 500.0, 320.0, 240.0, 0.01, -0.02, 0.001, 0.0}) Add(&bytes, p);
  return bytes;
}

std::string BinaryImages() {
  std::string bytes;
  Add<uint64_t>(&bytes, 2);
  for (uint32_t id = 1; id <= 2; ++id) {
    Add(&bytes, id);
    for (const double p : {1.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0}) Add(&bytes, p);
    Add<uint32_t>(&bytes, 1);
    bytes += "photo.jpg";
    bytes += '\0';
    Add<uint64_t>(&bytes, 2);
    for (int point = 0; point < 2; ++point) {
      Add(&bytes, 10.0);
      Add(&bytes, 20.0);
      Add<uint64_t>(&bytes, 1);
    }
  }
  return bytes;
}

std::string BinaryPoints() {
  std::string bytes;
  Add<uint64_t>(&bytes, 1);
  Add<uint64_t>(&bytes, 1);
  for (const double p : {1.0, 2.0, 3.0}) Add(&bytes, p);
  for (const char c : {'\x10', '\x20', '\x30'}) Add(&bytes, c);
  Add(&bytes, 0.5);
  Add<uint64_t>(&bytes, 2);
  for (const uint32_t id : {1U, 2U}) {
    Add(&bytes, id);
    Add<uint32_t>(&bytes, 0);
  }
  return bytes;
}

std::vector<std::string> WholeFiles() {
  const TemporaryFolder folder;
  survey::WriteColmapText(SmallModel(), folder.path());
  return {base::ReadFile(folder / "cameras.txt"),
          base::ReadFile(folder / "images.txt"),
          base::ReadFile(folder / "points3D.txt"),
          BinaryCameras(),
          BinaryImages(),
          BinaryPoints()};
}

}  // namespace

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds = WholeFiles();
  for (size_t i = 0; i < seeds.size(); ++i) seeds[i].insert(seeds[i].begin(), static_cast<char>('0' + static_cast<char>(i)));
  return seeds;
}

void Feed(const std::string& bytes) {
  static const std::vector<std::string> whole = WholeFiles();
  static const TemporaryFolder folder;
  if (bytes.empty()) return;
  const size_t which = static_cast<unsigned char>(bytes[0]) % std::size(kFiles);
  const size_t first = which < 3 ? 0 : 3;
  for (const char* name : kFiles) std::filesystem::remove(folder / name);
  for (size_t i = first; i < first + 3; ++i) std::ofstream(folder / kFiles[i], std::ios::binary) << (i == which ? bytes.substr(1) : whole[i]);
  try {
    survey::ReadColmapModel(folder.path());
  } catch (const base::InputError&) {
  }
  try {
    survey::ReadColmapObservations(folder.path());
  } catch (const base::InputError&) {
  }
}

}  // namespace skyquilt::fuzz
