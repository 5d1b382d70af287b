// The one list of what is in the photo folder: which files are photos, and why the others are not.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/picture_header.h"
#include "prepare/input/walk_folder.h"

namespace skyquilt::prepare::input {

enum class FileKind {
  kPhoto,      // taken; all others are left out
  kBand,       // one spectral band of a shot
  kThermal,    // picture of heat
  kOtherForm,  // another file of a shot that is taken: JPEG and DNG, JPEG and TIFF of one name
  kMask,
  kThumbnail,
  kMap,       // orthophoto or height model
  kProject,   // in the folder of another project
  kResult,    // made by another program, in a folder that says so
  kUnread,    // HEIC, raw, video: no program here reads it
  kSystem,    // hidden, or of the operating system; a name with '/' at its end is a folder
  kNoChoice,  // no pattern of prepare.photos is its own
  kDamaged,   // would be a photo
  kModel,     // camera model of another program
  kOther      // no picture
};

// As in the table.
std::string KindName(FileKind kind);

struct InputFile {
  std::string name;  // relative to the photo folder, '/' separated; with '/' at its end it stands for all files in that folder
  FileKind kind = FileKind::kOther;
  std::string reason;  // why it is left out, or taken in spite of something; empty for photos that need no word
  std::string shot;    // files with the same text here are of one shot; only of pictures
  std::string mask;    // file of its mask, or "alpha"; empty: none. Relative to the photo folder where it is inside
  int width = 0;       // pixels, as stored; 0: not known
  int height = 0;

  bool Taken() const { return kind == FileKind::kPhoto; }
};

struct ListOptions {
  std::vector<std::filesystem::path> skip;  // folders that are no input: the project's own
  std::filesystem::path masks;              // a folder of masks or a mask, wherever it is; empty: none
  std::string patterns;                     // prepare.photos (glob.h): photos are the pictures that match, whatever else would be left out
};

// All files below `root` in name order (bytes). A photo is a jpg, jpeg, png, tif or tiff, or a HEIC or raw file (core/image/develop.h), that is not
//   - a single band beside photos in colour; where there are hardly any, one band is taken for all
//   - a picture of heat beside photos in colour, by its name or by its size
//   - another form of a shot in the same folder: of JPEG, TIFF, PNG, HEIC and raw the first is taken
//   - a mask, thumbnail or map, by name, folder or header
//   - in the folder of another project, or hidden
// Patterns overrule all of these but masks and what is hidden. `threads`: reads the pictures' headers.
// Throws base::InputError when no photo is left, saying what there is, base::UsageError for patterns without any.
std::vector<InputFile> ListInput(const std::filesystem::path& root, const ListOptions& options, base::ThreadPool& threads);

// The decisions alone. `headers`: of each file, unknown where there is none; `patterns`: parsed, empty: none.
std::vector<InputFile> ChooseFiles(const std::vector<FoundFile>& found, const std::vector<PictureHeader>& headers,
                                   const std::vector<std::string>& patterns);

// Names of the photos, in their order.
std::vector<std::string> TakenNames(const std::vector<InputFile>& files);

// Whether a file is a JPEG, PNG or TIFF by its extension and not hidden. Nothing is read.
bool LooksLikePhoto(const std::filesystem::path& file);

}  // namespace skyquilt::prepare::input
