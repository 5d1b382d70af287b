// Photos of rigs in the search for poses. COLMAP 3.8 and the seeding by tags find them as single photos, the latter with one pose per shot; the last
// step is a bundle adjustment with one pose per shot, in which each camera stands on its rig as its file says.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_step.h"

namespace skyquilt::prepare::poses {

// Numbers of shots by their names, from 0 in the order in which they are asked for.
class ShotNumbers {
 public:
  int Of(const input::RigPlace& place) { return numbers_.emplace(place.shot, static_cast<int>(numbers_.size())).first->second; }

 private:
  std::map<std::string, int> numbers_;
};

bool AnyRig(const std::vector<input::PhotoFile>& photos);
// Whether all photos are computed views.
bool AllExact(const std::vector<input::PhotoFile>& photos);
// The same for photos with one lens; texts of inputs. RigInputs is empty for a photo of no rig.
std::string LensOfRig(const input::RigPlace& place);
std::string RigInputs(const input::PhotoFile& photo);

// Notes in a model which images are of one shot, and which cameras are exact, which get their lens. For models that PlaceByRigs made.
void MarkShots(const std::vector<input::PhotoFile>& photos, survey::ColmapModel& model);

// Writes to `to` the model of `from` with all photos of each shot that has one with a pose, at the rigs' scale, with points anew of all verified
// matches of the job's database. Lenses that are not exact are adjusted. Shots whose photos contradict the matches have no pose in it. Where a lens
// is one that the adjustment does not know (a fisheye), the shots' poses are the means of those found, and points stay. Throws base::InputError that
// names the rig's file when the poses of most of its photos contradict it, and when a file cannot be written; base::Interrupted.
void PlaceByRigs(const ColmapJob& job, const std::filesystem::path& from, const std::vector<input::PhotoFile>& photos,
                 const std::filesystem::path& to, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::poses
