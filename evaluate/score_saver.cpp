#include "evaluate/score_saver.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/system.h"
#include "evaluate/photos/scored_pixels.h"

namespace skyquilt::evaluate {

namespace {

constexpr double kShareOfTime = 0.05;
// Packing takes as much memory as the values themselves, which are billions in large simulated surveys.
constexpr int64_t kShareOfMemory = 8;

constexpr const char* kScoresVersion = "3";  // of how photos are scored

std::string KeyOf(const EvaluateInput& input, const std::vector<int>& held_out) {
  std::string key = std::string(kScoresVersion) + "\n" + input.progress_key + "\n" + input.options.scored_pixels_folder.string() + "\n";
  for (const int photo : held_out) key.append(std::to_string(photo)).append(" ");
  return key;
}

bool ScoredPixelsExist(const metrics::Scores& scores, const std::filesystem::path& folder) {
  std::error_code ignored;
  return folder.empty() || std::all_of(scores.photos.begin(), scores.photos.end(), [&](const photos::PhotoScore& photo) {
           return std::filesystem::is_regular_file(photos::ScoredPixelsFile(folder, photo.name), ignored);
         });
}

}  // namespace

bool SaveSchedule::Due(double now_s) const {
  return now_s - last_s_ >= std::max(every_s_, took_s_ / kShareOfTime);
}

void SaveSchedule::Saved(double begin_s, double end_s) {
  took_s_ = end_s - begin_s;
  last_s_ = end_s;
}

ScoreSaver::ScoreSaver(const EvaluateInput& input, const std::vector<int>& held_out, ScoreState state)
    : input_(input),
      n_photos_(held_out.size()),
      state_(state),
      file_(input.progress_file, KeyOf(input, held_out)),
      schedule_(input.options.save_every_s, 0.0) {
  SKYQUILT_CHECK(state.scores != nullptr && state.pictures != nullptr, "scores and pictures must be set");
}

double ScoreSaver::Now() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void ScoreSaver::Load(base::ByteUnpacker* in) {
  metrics::Scores scores = *state_.scores;
  page::WrittenPictures pictures = *state_.pictures;
  surface::SurfacePhotoErrors surface;
  const auto seconds = in->Take<double>();
  scores.Load(in);
  pictures.Load(in);
  if (in->Take<bool>() != (state_.surface != nullptr)) in->Fail();
  if (state_.surface != nullptr) surface.Load(in);
  in->End();
  const size_t n = scores.photos.size();
  if (n > n_photos_ || pictures.images.size() != n || (state_.surface != nullptr && surface.n_photos() != n)) in->Fail();
  if (!pictures.Exist(input_.ReportFolder())) throw base::UnreadableBytes("pictures of the report are missing");
  if (!ScoredPixelsExist(scores, input_.options.scored_pixels_folder)) throw base::UnreadableBytes("pictures of scored pixels are missing");
  *state_.scores = std::move(scores);
  *state_.pictures = std::move(pictures);
  if (state_.surface != nullptr) *state_.surface = std::move(surface);
  earlier_s_ = seconds;
}

void ScoreSaver::Resume() {
  if (input_.progress_file.empty()) return;
  if (!file_.Read([this](base::ByteUnpacker* in) { Load(in); })) return;
  base::LogInfo("evaluate: continues after {} of {} photos", state_.scores->photos.size(), n_photos_);
}

void ScoreSaver::SaveWhenDue() {
  if (schedule_.Due(Now())) Save();
}

void ScoreSaver::Save() {
  if (input_.progress_file.empty()) return;
  const double begin_s = Now();
  const auto warn_once = [this](const std::string& why) {
    if (!warned_) base::LogWarning("the scores so far are not saved, so an evaluation that is interrupted now begins anew or loses photos: {}", why);
    warned_ = true;
  };
  if (static_cast<int64_t>(n_bytes_) > base::TotalMemoryBytes() / kShareOfMemory) {
    warn_once("they take more than an eighth of the memory");
    return;
  }
  try {
    n_bytes_ = file_.Write(n_bytes_ + n_bytes_ / 4, [this](base::BytePacker* out) {
      out->Add(earlier_s_ + Now());
      state_.scores->Save(out);
      state_.pictures->Save(out);
      out->Add(state_.surface != nullptr);
      if (state_.surface != nullptr) state_.surface->Save(out);
    });
  } catch (const base::InputError& error) {
    warn_once(error.what());
  }
  schedule_.Saved(begin_s, Now());
}

void ScoreSaver::Remove() const {
  if (!input_.progress_file.empty()) file_.Remove();
}

}  // namespace skyquilt::evaluate
