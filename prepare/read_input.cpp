#include "prepare/read_input.h"

#include <unordered_map>

#include "core/base/log.h"
#include "prepare/input/input_table.h"
#include "prepare/input/shots.h"

namespace skyquilt::prepare {

std::vector<input::InputFile> ListFiles(const PrepareInput& input, const PrepareOptions& options, const input::InputFolder& folders,
                                        base::ThreadPool& threads) {
  const input::ListOptions list{.skip = {input.out_folder, std::filesystem::absolute(input.out_folder).parent_path()},
                                .masks = folders.masks.given,
                                .patterns = options.photos};
  std::vector<input::InputFile> files = input::ListInput(folders.photo_root, list, threads);
  input::WriteInputTable(files, input.out_folder / kInputTable);
  base::LogInfo(input::SummaryText(files, input.out_folder / kInputTable));
  for (const std::string& warning : input::InputWarnings(folders.photo_root, files)) base::LogWarning(warning);
  return files;
}

void NoteReadPhotos(const input::PhotoSet& photos, std::vector<input::InputFile>& files) {
  const std::vector<size_t> shots = input::FindShots(photos.usable);
  const size_t n_shots = input::CountShots(shots);
  if (n_shots < photos.usable.size()) {
    base::LogInfo("{} photos are of {} shots, as exposure brackets; prepare.photos can choose one exposure of each by their names",
                  photos.usable.size(), n_shots);
  }
  std::unordered_map<std::string, input::InputFile*> by_name;
  for (input::InputFile& file : files) by_name.emplace(file.name, &file);
  for (const std::string& name : photos.unreadable) {
    by_name.at(name)->kind = input::FileKind::kDamaged;
    by_name.at(name)->reason = "cannot be used: the log says why";
  }
  for (size_t i = 0; i < shots.size(); ++i) by_name.at(photos.usable[i].name)->shot = by_name.at(photos.usable[shots[i]].name)->shot;
}

}  // namespace skyquilt::prepare
