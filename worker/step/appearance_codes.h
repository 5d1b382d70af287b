// A code per training photo, some numbers that the colour network sees beside position and direction (field::FieldConfig::appearance), so that photos
// of other light, weather or exposure need not agree on one colour (Martin-Brualla et al. 2021, NeRF in the Wild, section 4.1; there without
// centring). The codes are learned together with one field, by the gradient of its losses, with Adam as the field's parameters and at its learning
// rate; photos without a gradient in a step keep code and moments. All start at 0, where photos look alike; they part because their gradients differ.
// Renderings have no photo, so they show code 0. A common shift of all codes can be undone by the network, so nothing but a rule keeps 0 among them:
// after every step the mean over the photos that were ever drawn is subtracted, and 0 is their mean look. This is a projection and not a penalty for
// the reason given in core/brightness/response_learner.h. The mean of the codes need not give the mean of the colours: where photos are of two kinds
// only, no photo looks like code 0, and what the network gives there was never trained.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/survey/survey.h"

namespace skyquilt::worker {

// Which photos share a code.
struct CodeGroups {
  std::vector<int> of_photo;       // per photo of the survey, index of its group
  std::vector<std::string> names;  // per group
};
// by: "photo": every photo is a group of its name; "folder": a group has the photos of one folder and its path, which is empty for photos without.
CodeGroups GroupPhotos(const survey::Survey& survey, const std::string& by);

class AppearanceCodes {
 public:
  // For so many photos, all of the survey, so that a photo's number finds its code; those of photos that are never drawn, such as held-out ones, stay
  // 0. numbers: of a code; 0: off.
  AppearanceCodes(size_t photos, int numbers);
  // One code per group, which then stands for "photo" below.
  AppearanceCodes(CodeGroups groups, int numbers);

  bool On() const { return numbers_ > 0; }
  size_t numbers() const { return numbers_; }
  // `numbers()` numbers.
  const float* Of(int photo) const { return state_.codes.data() + Row(photo) * numbers_; }
  // Adds d loss / d code of one ray, `numbers()` numbers. The sums depend on the order of the rays.
  void Add(int photo, const float* gradient);
  // One Adam step with the gradients added since the last one. A photo whose gradient is not finite keeps its code.
  void Step(double learning_rate);

  // All that a step changes: whoever keeps it can go back to it.
  struct State {
    std::vector<float> codes, moment1, moment2;  // [group][number]
    std::vector<int64_t> steps;                  // updates per group; 0: not drawn yet
  };
  State& state() { return state_; }

  // Writes the state under "appearance/", nothing when off; the arrays must not change until the writer's Commit.
  void Put(checkpoint::ArchiveWriter& writer) const;
  // Throws base::InputError when the file has none, or for another number of photos or numbers. Does nothing when off.
  void Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

 private:
  void SubtractMean();

  size_t Row(int photo) const { return static_cast<size_t>(groups_.of_photo[static_cast<size_t>(photo)]); }

  CodeGroups groups_;
  size_t rows_, numbers_;
  State state_;
  std::vector<double> gradient_;  // of this step, as codes
  std::vector<uint8_t> touched_;  // per group: has a gradient in this step
};

}  // namespace skyquilt::worker
