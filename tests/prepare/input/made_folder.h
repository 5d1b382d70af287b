// A folder of files that are all but empty: names, and headers of pictures.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "prepare/input/list_files.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::test {

// The header of a TIFF without pixels. extra: the meaning of one more channel (1 or 2: alpha), negative: not stated.
inline std::string TiffHeader(int width, int height, int channels, int extra = -1, bool is_map = false) {
  std::string bytes = {'I', 'I', 42, 0, 8, 0, 0, 0};
  const auto number = [&bytes](uint32_t value, int size) {
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 255U);
  };
  const auto entry = [&](uint32_t tag, uint32_t value) {
    number(tag, 2);
    number(3, 2);
    number(1, 4);
    number(value, 4);
  };
  number(3U + (extra >= 0 ? 1U : 0U) + (is_map ? 2U : 0U), 2);
  entry(256, static_cast<uint32_t>(width));
  entry(257, static_cast<uint32_t>(height));
  entry(277, static_cast<uint32_t>(channels));
  if (extra >= 0) entry(338, static_cast<uint32_t>(extra));
  if (is_map) {
    entry(33550, 0);
    entry(34735, 0);
  }
  number(0, 4);
  return bytes;
}

class MadeFolder {
 public:
  // An empty file, or one with this content.
  void Add(const std::string& name, const std::string& content = "") {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }
  void AddAll(const std::vector<std::string>& names) {
    for (const std::string& name : names) Add(name);
  }
  void AddJpeg(const std::string& name, int width = 16, int height = 8) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    image::SaveJpeg(image::Image8(width, height, 3, 90), folder_ / name, 80);
  }
  void AddPng(const std::string& name, const image::Image8& pixels) { Add(name, image::EncodePng(pixels, 1)); }

  std::vector<prepare::input::InputFile> List(const prepare::input::ListOptions& options = {}) {
    files_ = prepare::input::ListInput(folder_.path(), options, threads_);
    return files_;
  }
  std::vector<std::string> Taken(const std::string& patterns = "") {
    prepare::input::ListOptions options;
    options.patterns = patterns;
    return prepare::input::TakenNames(List(options));
  }
  // In the last list; without a name when it has no such file.
  prepare::input::InputFile Row(const std::string& name) const {
    const auto found = std::find_if(files_.begin(), files_.end(), [&name](const prepare::input::InputFile& file) { return file.name == name; });
    return found == files_.end() ? prepare::input::InputFile() : *found;
  }

  const std::filesystem::path& path() const { return folder_.path(); }
  base::ThreadPool& threads() { return threads_; }

 private:
  TemporaryFolder folder_;
  base::ThreadPool threads_{2};
  std::vector<prepare::input::InputFile> files_;
};

}  // namespace skyquilt::test
