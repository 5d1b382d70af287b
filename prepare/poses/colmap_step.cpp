#include "prepare/poses/colmap_step.h"

#include <algorithm>
#include <cstdio>
#include <deque>

#include "core/base/child_process.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

fs::path StampFile(const ColmapJob& job, const std::string& step) {
  return job.folder / (step + ".done");
}

}  // namespace

void RunColmapCommand(const ColmapJob& job, const ColmapCommand& command, const std::function<void(const std::string& line)>& on_line) {
  std::deque<std::string> last_lines;
  base::Command run{command.program, {command.name}};
  run.arguments.insert(run.arguments.end(), command.arguments.begin(), command.arguments.end());
  // COLMAP links against Qt even for commands without a window; this lets it run without a display.
  run.environment = {"QT_QPA_PLATFORM=offscreen"};
  run.environment.insert(run.environment.end(), command.environment.begin(), command.environment.end());
  const int status = base::RunLogged(run, job.Log(), [&](const std::string& line) {
    last_lines.push_back(line);
    if (last_lines.size() > 3) last_lines.pop_front();
    on_line(line);
  });
  if (status == 0) return;
  std::string found = "COLMAP's " + command.name + " failed with status " + std::to_string(status);
  if (!last_lines.empty()) found += "; its last line: " + last_lines.back();
  if (command.name == "mapper" && status == 1) throw NoModelError(job.Log(), found, kNoModelFix);
  throw base::InputError(job.Log(), found, "Read the log; if memory ran out, lower prepare.max_image_size");
}

void RunWithProgress(const ColmapJob& job, const ColmapCommand& command, const std::string& label, size_t n_photos) {
  const auto total = static_cast<double>(n_photos);
  base::Progress progress(label, total, "photos");
  double share = 0.0;
  RunColmapCommand(job, command, [&](const std::string& line) {
    share = std::max(share, ColmapLineProgress(line, n_photos));
    progress.Update(share * total);
  });
  progress.Update(total);
  progress.Finish();
}

double ColmapLineProgress(const std::string& line, size_t n_photos) {
  unsigned a = 0, b = 0, c = 0, d = 0;
  const auto share = [](double done, double total) { return total > 0.0 ? std::clamp(done / total, 0.0, 1.0) : -1.0; };
  if (const size_t at = line.find("Processed file ["); at != std::string::npos) {
    if (std::sscanf(line.c_str() + at, "Processed file [%u/%u]", &a, &b) == 2) return share(a, b);
  }
  if (const size_t at = line.find("Matching block ["); at != std::string::npos) {
    // Printed before each block of pairs: "[row/rows, column/columns]".
    if (std::sscanf(line.c_str() + at, "Matching block [%u/%u, %u/%u]", &a, &b, &c, &d) == 4 && a > 0 && c > 0) {
      return share((a - 1.0) * d + (c - 1.0), static_cast<double>(b) * d);
    }
    if (std::sscanf(line.c_str() + at, "Matching block [%u/%u]", &a, &b) == 2 && a > 0) return share(a - 1.0, b);
  }
  if (const size_t at = line.find("Matching image ["); at != std::string::npos) {
    if (std::sscanf(line.c_str() + at, "Matching image [%u/%u]", &a, &b) == 2 && a > 0) return share(a - 1.0, b);
  }
  if (const size_t at = line.find("Registering image #"); at != std::string::npos) {
    if (std::sscanf(line.c_str() + at, "Registering image #%u (%u)", &a, &b) == 2 && b > 0) return share(b - 1.0, static_cast<double>(n_photos));
  }
  return -1.0;
}

bool IsDone(const ColmapJob& job, const ColmapStep& step) {
  const fs::path stamp = StampFile(job, step.name);
  const fs::path product = step.name == kModelStep || step.name == kHeldFocalStep ? job.Models() : job.Database();
  return fs::exists(product) && fs::exists(stamp) && base::ReadFile(stamp) == step.hash + "\n";
}

void MarkDone(const ColmapJob& job, const ColmapStep& step) {
  base::WriteFileAtomically(StampFile(job, step.name), step.hash + "\n");
}

void ForgetStep(const ColmapJob& job, const std::string& name) {
  fs::remove(StampFile(job, name));
}

void RunStep(const ColmapJob& job, const ColmapStep& step, const std::vector<std::string>& later, const std::function<void()>& run) {
  if (IsDone(job, step)) {
    base::LogInfo("COLMAP {}: already done", step.name);
    return;
  }
  ForgetStep(job, step.name);
  for (const std::string& name : later) ForgetStep(job, name);
  run();
  MarkDone(job, step);
}

}  // namespace skyquilt::prepare::poses
