// Steps from the files of a folder to photos, with the table of what became of each (input.csv).
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/input_folder.h"
#include "prepare/input/list_files.h"
#include "prepare/input/photo_files.h"
#include "prepare/prepare.h"
#include "prepare/prepare_options.h"

namespace skyquilt::prepare {

constexpr const char* kInputTable = "input.csv";

// All files of the photo folder, with a table of them even where too few can be used.
std::vector<input::InputFile> ListFiles(const PrepareInput& input, const PrepareOptions& options, const input::InputFolder& folders,
                                        base::ThreadPool& threads);
// What reading the photos told: those that are damaged, and those of one shot.
void NoteReadPhotos(const input::PhotoSet& photos, std::vector<input::InputFile>& files);

}  // namespace skyquilt::prepare
