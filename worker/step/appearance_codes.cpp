#include "worker/step/appearance_codes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "core/checkpoint/take_array.h"
#include "core/kernel/kernels.h"

namespace skyquilt::worker {
namespace {

CodeGroups OwnGroups(size_t photos) {
  CodeGroups groups{std::vector<int>(photos), std::vector<std::string>(photos)};
  std::iota(groups.of_photo.begin(), groups.of_photo.end(), 0);
  return groups;
}

}  // namespace

CodeGroups GroupPhotos(const survey::Survey& survey, const std::string& by) {
  CodeGroups groups;
  std::map<std::string, int> known;
  for (const survey::Photo& photo : survey.photos) {
    const std::string name = by == "folder" ? std::filesystem::path(photo.name).parent_path().generic_string() : photo.name;
    const auto [group, is_new] = known.emplace(name, static_cast<int>(groups.names.size()));
    if (is_new) groups.names.push_back(name);
    groups.of_photo.push_back(group->second);
  }
  return groups;
}

AppearanceCodes::AppearanceCodes(size_t photos, int numbers) : AppearanceCodes(OwnGroups(photos), numbers) {}

AppearanceCodes::AppearanceCodes(CodeGroups groups, int numbers)
    : groups_(std::move(groups)), rows_(numbers > 0 ? groups_.names.size() : 0), numbers_(static_cast<size_t>(numbers)) {
  for (auto* values : {&state_.codes, &state_.moment1, &state_.moment2}) values->assign(rows_ * numbers_, 0.0F);
  state_.steps.assign(rows_, 0);
  gradient_.assign(rows_ * numbers_, 0.0);
  touched_.assign(rows_, 0);
}

void AppearanceCodes::Add(int photo, const float* gradient) {
  const size_t row = Row(photo);
  touched_[row] = 1;
  for (size_t k = 0; k < numbers_; ++k) gradient_[row * numbers_ + k] += static_cast<double>(gradient[k]);
}

void AppearanceCodes::Step(double learning_rate) {
  kernel::AdamStep step;
  step.learning_rate = static_cast<float>(learning_rate);
  std::vector<float> gradient(numbers_);
  for (size_t photo = 0; photo < rows_; ++photo) {
    if (touched_[photo] == 0) continue;
    const size_t first = photo * numbers_;
    std::transform(gradient_.begin() + static_cast<std::ptrdiff_t>(first), gradient_.begin() + static_cast<std::ptrdiff_t>(first + numbers_),
                   gradient.begin(), [](double value) { return static_cast<float>(value); });
    std::fill_n(gradient_.begin() + static_cast<std::ptrdiff_t>(first), numbers_, 0.0);
    touched_[photo] = 0;
    if (!kernel::AllFinite(gradient.data(), static_cast<int64_t>(numbers_))) continue;
    const auto t = static_cast<double>(++state_.steps[photo]);
    step.correction1 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta1), t));
    step.correction2 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta2), t));
    kernel::AdamDense(step, 0.0F, static_cast<int64_t>(numbers_), state_.codes.data() + first, gradient.data(), state_.moment1.data() + first,
                      state_.moment2.data() + first);
  }
  SubtractMean();
}

void AppearanceCodes::SubtractMean() {
  const auto drawn = rows_ - static_cast<size_t>(std::count(state_.steps.begin(), state_.steps.end(), 0));
  for (size_t k = 0; k < numbers_ && drawn > 0; ++k) {
    double sum = 0.0;  // photos that were not drawn have 0
    for (size_t photo = 0; photo < rows_; ++photo) sum += static_cast<double>(state_.codes[photo * numbers_ + k]);
    const auto mean = static_cast<float>(sum / static_cast<double>(drawn));
    for (size_t photo = 0; photo < rows_; ++photo) {
      if (state_.steps[photo] > 0) state_.codes[photo * numbers_ + k] -= mean;
    }
  }
}

void AppearanceCodes::Put(checkpoint::ArchiveWriter& writer) const {
  if (!On()) return;
  const std::vector<int64_t> shape = {static_cast<int64_t>(rows_), static_cast<int64_t>(numbers_)};
  writer.Put("appearance/codes", state_.codes, shape);
  writer.Put("appearance/moment1", state_.moment1, shape);
  writer.Put("appearance/moment2", state_.moment2, shape);
  writer.Put("appearance/steps", state_.steps);
  std::vector<uint8_t> names;
  for (const std::string& name : groups_.names) {
    names.insert(names.end(), name.begin(), name.end());
    names.push_back(0);
  }
  writer.PutOwned("appearance/names", std::move(names));
}

void AppearanceCodes::Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  if (!On()) return;
  const auto take = [&](auto& to, const auto& from, const char* name) { checkpoint::TakeArray(from, name, file, "survey", to); };
  take(state_.codes, reader.Floats("appearance/codes"), "appearance/codes");
  take(state_.moment1, reader.Floats("appearance/moment1"), "appearance/moment1");
  take(state_.moment2, reader.Floats("appearance/moment2"), "appearance/moment2");
  take(state_.steps, reader.Ints("appearance/steps"), "appearance/steps");
}

}  // namespace skyquilt::worker
