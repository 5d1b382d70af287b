#include "worker/block_session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/checkpoint/take_array.h"
#include "core/scene/field_file.h"

namespace skyquilt::worker {
namespace {

// Checkpoints of older programs have no guard.
double DoubleOr(const checkpoint::ArchiveReader& reader, const char* name, double missing) {
  return reader.HasAttribute(name) ? reader.DoubleAttribute(name) : missing;
}

int64_t IntOr(const checkpoint::ArchiveReader& reader, const char* name, int64_t missing) {
  return reader.HasAttribute(name) ? reader.IntAttribute(name) : missing;
}

// Writes what the guard knows and found. Returns the numbers that the writer refers to.
std::array<std::vector<double>, 2> PutGuard(const TrainJob& job, const SessionRecord& record, checkpoint::ArchiveWriter& writer) {
  writer.SetAttribute("attempt", static_cast<int64_t>(job.attempt));
  writer.SetAttribute("learning_rate_scale", job.learning_rate_scale);
  writer.SetAttribute("rate_factor", record.rate_factor);
  writer.SetAttribute("ended_early", static_cast<int64_t>(record.ended_early ? 1 : 0));
  if (record.comparison) {
    writer.SetAttribute("block_psnr_db", record.comparison->block_psnr_db);
    writer.SetAttribute("context_psnr_db", record.comparison->context_psnr_db);
    writer.SetAttribute("block_is_worse", static_cast<int64_t>(record.comparison->block_is_worse ? 1 : 0));
  }
  const FallGuard::State& g = record.guard;
  std::array<std::vector<double>, 2> numbers;
  numbers[0] = {g.best.mean,
                g.best.error,
                g.last.mean,
                g.last.error,
                static_cast<double>(g.bad_in_a_row),
                g.swing,
                g.previous,
                static_cast<double>(g.windows),
                g.sum,
                g.squares,
                g.saturated,
                static_cast<double>(g.count)};
  writer.Put("guard", numbers[0]);
  for (const Fall& fall : record.falls) {
    numbers[1].insert(numbers[1].end(), {static_cast<double>(fall.step), fall.best_psnr_db, fall.psnr_db, static_cast<double>(fall.restored_step)});
  }
  if (!record.falls.empty()) writer.Put("falls", numbers[1], {static_cast<int64_t>(record.falls.size()), 4});
  return numbers;
}

void GetGuard(const checkpoint::ArchiveReader& reader, SessionRecord& record) {
  record.rate_factor = DoubleOr(reader, "rate_factor", 1.0);
  record.ended_early = IntOr(reader, "ended_early", 0) != 0;
  if (reader.Has("guard")) {
    const std::vector<double> g = reader.Doubles("guard");
    if (g.size() == 12) {
      record.guard = {.best = {g[0], g[1]},
                      .last = {g[2], g[3]},
                      .bad_in_a_row = static_cast<int>(g[4]),
                      .swing = g[5],
                      .windows = static_cast<int>(g[7]),
                      .previous = g[6],
                      .sum = g[8],
                      .squares = g[9],
                      .saturated = g[10],
                      .count = static_cast<int>(g[11])};
    }
  }
  if (reader.HasAttribute("block_is_worse")) {
    record.comparison = {reader.DoubleAttribute("block_psnr_db"), reader.DoubleAttribute("context_psnr_db"),
                         reader.IntAttribute("block_is_worse") != 0};
  }
  if (!reader.Has("falls")) return;
  const std::vector<double> falls = reader.Doubles("falls");
  for (size_t i = 0; i + 3 < falls.size(); i += 4) {
    record.falls.push_back({static_cast<int64_t>(falls[i]), falls[i + 1], falls[i + 2], static_cast<int64_t>(falls[i + 3])});
  }
}

std::string ProposalName(size_t proposal, const char* array) {
  return "proposal" + std::to_string(proposal) + "_" + array;
}

// Calls visit(name, array, state) for every array of a sampler's proposals.
template <typename Visit>
void VisitProposals(FieldTrainer& trainer, const Visit& visit) {
  if (trainer.sampler() == nullptr) return;
  const auto proposals = trainer.sampler()->proposals();
  for (size_t i = 0; i < proposals.size(); ++i) {
    ProposalNetwork& proposal = *proposals[i];
    visit(ProposalName(i, "grid"), proposal.parameters().grid);
    visit(ProposalName(i, "networks"), proposal.parameters().networks);
    visit(ProposalName(i, "grid_moment1"), proposal.state().grid_moment1);
    visit(ProposalName(i, "grid_moment2"), proposal.state().grid_moment2);
    visit(ProposalName(i, "network_moment1"), proposal.state().network_moment1);
    visit(ProposalName(i, "network_moment2"), proposal.state().network_moment2);
  }
}

}  // namespace

void SaveSession(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, const SessionRecord& record,
                 const ContextBrightness* extras, const ContextResults* findings) {
  const field::OptimizerState& state = trainer.state();
  target.steps = state.step;
  target.seconds = record.seconds;
  target.samples = record.samples;

  checkpoint::ArchiveWriter writer(kind, scene::kCheckpointVersion);
  scene::PutField(target, "", writer);
  writer.Put("grid_moment1", state.grid_moment1);
  writer.Put("grid_moment2", state.grid_moment2);
  writer.Put("network_moment1", state.network_moment1);
  writer.Put("network_moment2", state.network_moment2);
  VisitProposals(trainer, [&](const std::string& name, const std::vector<float>& array) { writer.Put(name, array); });
  for (size_t i = 0; trainer.sampler() != nullptr && i < trainer.sampler()->proposals().size(); ++i) {
    writer.SetAttribute(ProposalName(i, "steps"), trainer.sampler()->proposals()[i]->state().step);
  }
  trainer.codes().Put(writer);
  if (trainer.poses() != nullptr) trainer.poses()->Put(writer);
  writer.SetAttribute("config_hash", job.config_hash);
  writer.SetAttribute("seed", static_cast<int64_t>(job.seed));
  writer.SetAttribute("rays_per_step", static_cast<int64_t>(trainer.rays_per_step()));
  writer.SetAttribute("rays", record.rays);
  writer.SetAttribute("dropped_steps", static_cast<int64_t>(record.dropped_steps));
  writer.SetAttribute("mean_squared_error", record.mean_squared_error);
  writer.SetAttribute("network_gradient_norm", state.network_gradient_norm);
  const std::array<std::vector<double>, 2> guard = PutGuard(job, record, writer);  // must exist until Commit
  writer.SetAttribute("complete", static_cast<int64_t>(record.complete ? 1 : 0));
  writer.SetAttribute("origin_latitude_deg", job.survey->origin.latitude_deg);
  writer.SetAttribute("origin_longitude_deg", job.survey->origin.longitude_deg);
  writer.SetAttribute("origin_height_m", job.survey->origin.height_m);
  if (extras != nullptr) {
    brightness::PutResponse(*extras->response, writer);
    extras->learner->Put(writer);
    brightness::PutLuminance(job.luminance, trainer.luminance_state(), writer);
  }
  if (findings != nullptr) {
    scene::PutBackground(findings->background, writer);
    static_assert(sizeof(SurfaceInterval) == 3 * sizeof(float) && std::is_trivially_copyable_v<SurfaceInterval>);
    const std::span<const float> numbers(reinterpret_cast<const float*>(findings->bands.data()), 3 * findings->bands.size());
    writer.Put("surface_intervals", numbers, {static_cast<int64_t>(job.survey->photos.size()), kTileRows, kTileColumns, 3});
  }
  writer.Commit(job.checkpoint);
}

std::optional<SavedSession> OpenSession(const std::string& kind, const TrainJob& job) {
  if (!std::filesystem::exists(job.checkpoint) && !std::filesystem::exists(job.checkpoint.string() + ".prev")) return std::nullopt;
  std::string why;
  const std::filesystem::path usable = checkpoint::NewestUsable(job.checkpoint, kind, &why);
  if (usable.empty()) {
    base::LogWarning("{}: cannot be used ({}); training this field from the beginning", job.checkpoint.string(), why);
    return std::nullopt;
  }
  checkpoint::ArchiveReader reader(usable);
  reader.RequireVersion(scene::kCheckpointVersion);
  if (reader.StringAttribute("config_hash") != job.config_hash) {
    throw base::UsageError(usable.string() +
                           ": was trained with another configuration. Use that configuration again, or --restart to train from the beginning");
  }
  return SavedSession{usable, std::move(reader)};
}

namespace {

SessionRecord RecordOf(const checkpoint::ArchiveReader& reader) {
  SessionRecord record;
  record.seconds = reader.DoubleAttribute("seconds");
  record.samples = reader.IntAttribute("samples");
  record.rays = reader.IntAttribute("rays");
  record.dropped_steps = static_cast<int>(reader.IntAttribute("dropped_steps"));
  record.mean_squared_error = reader.DoubleAttribute("mean_squared_error");
  GetGuard(reader, record);
  record.complete = reader.IntAttribute("complete") != 0;
  return record;
}

}  // namespace

double PsnrOfError(double mean_squared_error) {
  return std::isnan(mean_squared_error) ? mean_squared_error : -10.0 * std::log10(std::max(1e-10, mean_squared_error));
}

double RunningPsnr(const SessionRecord& record) {
  return PsnrOfError(record.mean_squared_error);
}

std::optional<TrainResult> FinishedResult(const SavedSession& session) {
  const SessionRecord record = RecordOf(session.reader);
  if (!record.complete) return std::nullopt;
  TrainResult result;
  result.ok = true;
  result.steps = session.reader.IntAttribute("steps");
  result.seconds = record.seconds;
  result.samples = record.samples;
  result.rays = record.rays;
  for (const char* array : {"grid", "networks"}) {
    int64_t count = 1;
    for (const int64_t n : session.reader.Shape(array)) count *= n;
    result.parameters += count;
  }
  result.final_psnr_db = RunningPsnr(record);
  result.dropped_steps = record.dropped_steps;
  result.falls = record.falls;
  result.ended_early = record.ended_early;
  result.comparison = record.comparison;
  return result;
}

int ContinueAttempt(const SavedSession& session, TrainJob& job) {
  const int attempt = static_cast<int>(IntOr(session.reader, "attempt", 0));
  if (attempt > job.attempt) {
    job.attempt = attempt;
    job.seed = static_cast<uint64_t>(session.reader.IntAttribute("seed"));
    job.learning_rate_scale = session.reader.DoubleAttribute("learning_rate_scale");
  }
  return attempt;
}

void LoadSession(const SavedSession& session, render::TrainedField& target, FieldTrainer& trainer, SessionRecord* record,
                 const ContextBrightness* extras) {
  const std::filesystem::path& usable = session.file;
  const checkpoint::ArchiveReader& reader = session.reader;
  render::TrainedField loaded = scene::GetField(reader, usable, "");
  field::OptimizerState& state = trainer.state();
  const auto take = [&](std::vector<float>& to, const std::vector<float>& from, const std::string& name) {
    checkpoint::TakeArray(from, name, usable, "configuration", to);
  };
  take(target.parameters.grid, loaded.parameters.grid, "grid");
  take(target.parameters.networks, loaded.parameters.networks, "networks");
  take(state.grid_moment1, reader.Floats("grid_moment1"), "grid_moment1");
  take(state.grid_moment2, reader.Floats("grid_moment2"), "grid_moment2");
  take(state.network_moment1, reader.Floats("network_moment1"), "network_moment1");
  take(state.network_moment2, reader.Floats("network_moment2"), "network_moment2");
  VisitProposals(trainer, [&](const std::string& name, std::vector<float>& array) { take(array, reader.Floats(name), name); });
  for (size_t i = 0; trainer.sampler() != nullptr && i < trainer.sampler()->proposals().size(); ++i) {
    trainer.sampler()->proposals()[i]->state().step = reader.IntAttribute(ProposalName(i, "steps"));
  }
  trainer.codes().Get(reader, usable);
  if (trainer.poses() != nullptr) {
    trainer.poses()->Get(reader, usable);
    trainer.UpdatePoses();
  }
  if (extras != nullptr) {
    *extras->response = brightness::GetResponse(reader, usable);
    extras->learner->Get(reader, usable);
    brightness::Luminance as_configured;
    brightness::GetLuminance(reader, &as_configured, &trainer.luminance_state());
  }
  target.occupancy = std::move(loaded.occupancy);
  target.footprint_min_m = loaded.footprint_min_m;
  target.footprint_max_m = loaded.footprint_max_m;
  state.step = loaded.steps;
  state.network_gradient_norm = DoubleOr(reader, "network_gradient_norm", 0.0);
  trainer.rays_per_step() = static_cast<int>(reader.IntAttribute("rays_per_step"));
  *record = RecordOf(reader);
}

namespace {

std::vector<SurfaceInterval> IntervalsOf(const std::vector<float>& numbers) {
  std::vector<SurfaceInterval> intervals;
  intervals.reserve(numbers.size() / 3);
  for (size_t i = 0; i + 2 < numbers.size(); i += 3) intervals.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  return intervals;
}

// Of these photos only, if the file has the shape that the present program writes.
void LoadIntervals(const checkpoint::ArchiveReader& reader, const std::vector<int>* photos, LoadedContext* context) {
  constexpr const char* kName = "surface_intervals";
  if (!reader.Has(kName)) return;
  const std::vector<int64_t> shape = reader.Shape(kName);
  if (photos == nullptr || shape.size() != 4 || shape[1] != kTileRows || shape[2] != kTileColumns || shape[3] != 3) {
    context->bands = IntervalsOf(reader.Floats(kName));
    return;
  }
  std::vector<int64_t> rows;
  for (const int photo : *photos) {
    if (photo >= 0 && photo < shape[0]) rows.push_back(photo);
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  context->place_in_bands.assign(static_cast<size_t>(shape[0]), -1);
  for (size_t i = 0; i < rows.size(); ++i) context->place_in_bands[static_cast<size_t>(rows[i])] = static_cast<int32_t>(i);
  context->bands = IntervalsOf(reader.FloatRows(kName, rows));
}

}  // namespace

namespace {

// The newest checkpoint of a context that can be read.
checkpoint::ArchiveReader OpenContext(const std::filesystem::path& checkpoint, std::filesystem::path* usable) {
  if (!std::filesystem::exists(checkpoint) && !std::filesystem::exists(checkpoint.string() + ".prev")) {
    throw base::InputError(checkpoint, "does not exist",
                           "The context is trained before the blocks; run train on the machine and folder that have it");
  }
  std::string why;
  *usable = checkpoint::NewestUsable(checkpoint, "context", &why);
  if (usable->empty()) throw base::InputError(checkpoint, "cannot be read (" + why + ")", "Train it again with --restart");
  checkpoint::ArchiveReader reader(*usable);
  reader.RequireVersion(scene::kCheckpointVersion);
  return reader;
}

}  // namespace

std::optional<survey::RefinedPoses> LoadContextPoses(const std::filesystem::path& checkpoint, const survey::Survey& survey) {
  std::filesystem::path usable;
  return ReadRefinedPoses(OpenContext(checkpoint, &usable), usable, survey);
}

LoadedContext LoadContext(const std::filesystem::path& checkpoint, const std::vector<int>* photos) {
  std::filesystem::path usable;
  const checkpoint::ArchiveReader reader = OpenContext(checkpoint, &usable);
  LoadedContext context{scene::GetField(reader, usable, ""), brightness::GetResponse(reader, usable), {}, {}, {}, {}};
  brightness::GetLuminance(reader, &context.luminance, &context.luminance_state);
  LoadIntervals(reader, photos, &context);
  return context;
}

}  // namespace skyquilt::worker
