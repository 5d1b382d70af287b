#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "app/bench/bench_commands.h"
#include "bench/numerics/numerics_bench.h"
#include "core/base/file.h"
#include "core/base/random.h"

namespace skyquilt::app {
namespace {

namespace fs = std::filesystem;

// Folder for the surveys that cases make: in the output folder, or in the system's temporary folder. Removed at the end, also after an exception.
class WorkFolder {
 public:
  explicit WorkFolder(const std::string& out)
      : path_((out.empty() ? fs::temp_directory_path() / ("skyquilt_numerics_" + base::RandomToken()) : fs::path(out) / "work")) {
    base::RequireWritableFolder(path_);
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string OnlyText(const std::vector<std::string>& only) {
  std::string text;
  for (const std::string& id : only) text += (text.empty() ? " --only " : ",") + id;
  return text;
}

}  // namespace

void AddNumericsBench(CLI::App& bench, CommandState& state) {
  struct Flags {
    std::string out;
    std::vector<std::string> only;
    bool quick = false;
    bool json = false;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* command = bench.add_subcommand("numerics", "check numerical accuracy in extreme cases, against double precision");
  command->add_option("-o,--out,--output", flags->out, "folder for numerics.json, numerics.html and one CSV table per group")->type_name("DIR");
  command
      ->add_option("--only", flags->only,
                   "only these groups of cases, separated by commas: space, rays, compositing, field, trainer, cones, away, ...")
      ->delimiter(',')
      ->type_name("GROUPS");
  command->add_flag("--quick", flags->quick, "fewer cases and shorter trainings");
  command->add_flag("--json", flags->json, "print JSON instead of the tables");
  command->footer(
      "Examples:\n"
      "  skyquilt bench numerics\n"
      "  skyquilt bench numerics --quick -o out/bench\n"
      "  skyquilt bench numerics --only space,earth\n"
      "Exit status 5 when a case fails.");
  command->callback([&state, flags] {
    state.run_command = [&state, flags] {
      if (state.comm != nullptr && state.comm->rank() != 0) return;
      if (!flags->out.empty()) base::RequireWritableFolder(flags->out);
      const WorkFolder work(flags->out);
      const bench::NumericsOptions options{
          .quick = flags->quick, .silent = state.quiet, .threads = BenchThreads(state), .work_folder = fs::absolute(work.path()), .comm = state.comm};
      std::vector<bench::NumericGroup> groups = bench::AllGroups(options);
      if (!flags->only.empty()) groups = bench::OnlyGroups(std::move(groups), flags->only);
      const bench::NumericsResult result = bench::RunNumerics(groups, options.quick);
      const std::string line = std::string("skyquilt bench numerics") + (flags->quick ? " --quick" : "") + OnlyText(flags->only);
      const bench::BenchPage page = bench::NumericsPage(result, line);
      const std::string json = bench::NumericsJson(result, line);
      std::cout << (flags->json ? json : bench::BenchText(page));
      if (!flags->out.empty()) bench::WriteBench(flags->out, page, json);
      bench::ThrowIfFailed(result);
    };
  });
}

}  // namespace skyquilt::app
