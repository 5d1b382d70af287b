// How much work a survey is, in counts. Times, memory and disk are predicted from it.
#pragma once

#include <filesystem>

#include "coordinator/project/settings.h"
#include "core/base/thread_pool.h"
#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::coordinator {

struct WorkSize {
  int photos = 0;
  int held_out = 0;
  double photo_pixels = 0.0;    // mean of the files
  int photo_width = 0;          // of the widest, pixels
  double surface_pixels = 0.0;  // area to map, in pixels of photos at full size
  int blocks = 1;               // that are trained
  int log2_table_size = 0;      // largest; 0: not known yet
  double photo_gsd_m = 0.0;     // ground sampling distance of photos at full size; 0: not known yet
  bool poses_given = false;     // by a camera model: none are searched
  bool tagged = true;           // most photos have positions
  bool level = false;           // photos look level: there are no maps and no buildings
  bool truth = false;           // simulated: also scored against the true surface
  int threads = 1;              // of one machine
  int ranks = 1;
  int machines = 1;

  // Of one photo scaled down to this width; 0: full size; kAutoWidth: as for kLeastAutoWidth.
  double PixelsAt(int image_width) const;
  // The area to map, in pixels of photos of this width.
  double SurfacePixelsAt(int image_width) const;
  // Ground sampling distance in photos of this width, metres; 0: not known yet.
  double GsdAt(int image_width) const;
  int TrainingPhotos() const { return photos - held_out; }
  // How many times as fast as one machine all ranks do work that they share. Rank 0 only hands it out.
  double Speedup() const;
};

// What the photo folder tells before anything is done: their number, sizes and some tags; the area and the blocks are guessed. project_folder: not
// searched for photos; may be empty. Throws base::InputError when there are no photos.
WorkSize CountPhotos(const std::filesystem::path& photos, const std::filesystem::path& model, const Settings& settings,
                     const std::filesystem::path& project_folder, base::ThreadPool& threads);
// Replaces the guesses by what a prepared survey tells, and by its blocks.
void CountSurvey(const survey::Survey& survey, WorkSize* size);
void CountBlocks(const partition::BlockSet& blocks, WorkSize* size);

}  // namespace skyquilt::coordinator
