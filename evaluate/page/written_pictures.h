// The pictures of held-out photos that an evaluation has written into the report's folder so far, for the page that shows them.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/packed_bytes.h"
#include "evaluate/page/brightness_report.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

struct WrittenPictures {
  std::vector<PhotoImages> images;    // one per scored photo, empty where it is not shown
  std::vector<BrightnessView> views;  // one per photo of the section "Brightness"; without paths until it is written
  int n_with_normals = 0;             // of the images

  // The list, not the files. Load throws base::UnreadableBytes for another number of views.
  void Save(base::BytePacker* out) const;
  void Load(base::ByteUnpacker* in);
  // Whether the files of the list exist.
  bool Exist(const std::filesystem::path& report_folder) const;
};

}  // namespace skyquilt::evaluate::page
