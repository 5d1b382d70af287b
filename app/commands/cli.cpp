#include "app/commands/cli.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/commands/command.h"
#include "coordinator/stages/serve_rank.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/system.h"
#include "core/config/options.h"

namespace skyquilt::app {
namespace {

enum ExitStatus : int { kDone = 0, kBug = 1, kUsage = 2, kInput = 3, kBlockFailed = 4, kCheckFailed = 5, kInterrupted = 130 };

// Ends the other ranks when rank 0 leaves, also after an exception.
class RankRelease {
 public:
  explicit RankRelease(comm::Communicator& comm) : comm_(comm) {}
  ~RankRelease() { coordinator::ReleaseRanks(comm_); }
  RankRelease(const RankRelease&) = delete;
  RankRelease& operator=(const RankRelease&) = delete;

 private:
  comm::Communicator& comm_;
};

std::string LongNames(const CLI::App& app, std::vector<std::string>* names) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names->push_back("--" + name);
  }
  return app.get_name();
}

// A message for the first word that is not understood, with the nearest known word.
std::string Suggestion(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  std::vector<std::string> words = app.remaining(true);
  if (words.empty()) return "";
  std::vector<std::string> known;
  LongNames(app, &known);
  if (chosen.empty()) {
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) known.push_back(command->get_name());
  } else {
    LongNames(*chosen.front(), &known);
  }
  const std::string word = words.front().substr(0, words.front().find('='));
  const std::string nearest = config::Nearest(word, known);
  const std::string kind = word.rfind('-', 0) == 0 ? "option" : chosen.empty() ? "command" : "argument";
  return "unknown " + kind + " '" + word + "'" + (nearest.empty() ? "" : ". Did you mean '" + nearest + "'?");
}

int ReportParseError(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const std::string suggestion = Suggestion(app);
  std::cerr << "skyquilt: " << (suggestion.empty() ? error.what() : suggestion) << "\n"
            << "Run 'skyquilt " << (chosen.empty() ? "" : chosen.front()->get_name() + " ") << "--help' for the commands and options.\n";
  return kUsage;
}

void AddCommands(CLI::App& app, CommandState& state, AddBenchCommand add_bench) {
  app.add_option("--config", state.config,
                 "TOML file with options, or a preset: fast, default, quality, level, or a method such as instant-ngp (see configs/)")
      ->type_name("FILE|NAME");
  app.add_option("--set", state.set, "set one option, for instance train.levels=10; may be repeated")
      ->type_name("SECTION.KEY=VALUE")
      ->expected(1)
      ->take_all();
  app.add_option("--threads", state.threads, "threads per machine; 0: all cores")->type_name("N");
  app.add_flag("--quiet", state.quiet, "print only warnings and errors");
  app.add_flag("--verbose", state.verbose, "print more details");
  app.set_version_flag("--version", std::string("skyquilt ") + SKYQUILT_VERSION);
  app.fallthrough();
  app.footer(
      "Examples:\n"
      "  skyquilt run photos/ -o out --time-budget 10min\n"
      "  mpirun -n 4 skyquilt run photos/ -o out --blocks 3x3\n"
      "  skyquilt run --place town -o out/town\n"
      "  skyquilt info out");
  AddRun(app, state);
  AddPlan(app, state);
  AddSimulate(app, state);
  AddPrepare(app, state);
  AddMasks(app, state);
  AddPartition(app, state);
  AddTrain(app, state);
  AddMerge(app, state);
  AddRender(app, state);
  AddSurface(app, state);
  AddBuildings(app, state);
  AddTour(app, state);
  AddOdm(app, state);
  AddEvaluate(app, state);
  AddView(app, state);
  AddInfo(app, state);
  add_bench(app, state);
}

constexpr const char* kBenchProgram = "skyquilt-bench";

std::filesystem::path BenchProgram() {
  std::error_code ignored;
  return std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / kBenchProgram;
}

// The first word that is neither an option nor the value of one.
std::string_view CommandOf(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--config" || word == "--set" || word == "--threads") {
      ++i;
    } else if (!word.starts_with("-")) {
      return word;
    }
  }
  return {};
}

// Replaces this process by the other program. Throws base::InputError when there is none.
[[noreturn]] void BecomeBench(char** argv) {
  execv(BenchProgram().c_str(), argv);
  throw base::InputError(BenchProgram(), "cannot be started: the benchmarks are a program of their own",
                         "Build it in the source folder: cmake --build --preset release --target skyquilt_bench");
}

// So that the program that does not have the command lists it.
void NameBench(CLI::App& app, CommandState& /*state*/) {
  app.add_subcommand("bench", "measure speed and accuracy");
}

// How many words the parser sees: all, but of 'skyquilt odm' only those up to "odm", because the others are OpenDroneMap's.
int ParsedWords(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "odm") return i + 1;
    if (!word.starts_with("--")) break;
  }
  return argc;
}

}  // namespace

int Guarded(const std::function<void()>& body) {
  try {
    body();
    return kDone;
  } catch (const base::UsageError& error) {
    base::LogError("{}", error.what());
    return kUsage;
  } catch (const base::InputError& error) {
    base::LogError("{}", error.what());
    return kInput;
  } catch (const base::BlockError& error) {
    base::LogError("{}", error.what());
    return kBlockFailed;
  } catch (const base::FailedCheck& error) {
    base::LogError("{}", error.what());
    return kCheckFailed;
  } catch (const base::Interrupted& error) {
    base::LogWarning("{}", error.what());
    return kInterrupted;
  } catch (const std::filesystem::filesystem_error& error) {
    base::LogError("{}. Check that the path exists, that you have permission and that the disk has free space", error.what());
    return kInput;
  } catch (const std::bad_alloc&) {
    base::LogError("out of memory. Use a smaller --image-width, more blocks, or fewer ranks on this machine");
    return kBug;
  } catch (const std::exception& error) {
    base::LogError("{}\nThis is a bug in skyquilt. Please report it with the project's log.txt. Results saved before are intact", error.what());
    return kBug;
  }
}

int RunCommandLine(int argc, char** argv, AddBenchCommand add_bench) {
  base::InitLog(false);
  // Before this process is one of several ranks.
  if (add_bench == nullptr && CommandOf(argc, argv) == "bench") return Guarded([argv] { BecomeBench(argv); });
  base::ReleaseAffinity();
  base::InstallSignalHandlers();
  std::unique_ptr<comm::Communicator> comm;
  if (const int status = Guarded([&comm] { comm = comm::Connect(); }); status != kDone) return status;
  if (comm->rank() != 0) {
    base::InitLog(false, "rank " + std::to_string(comm->rank()));
    Guarded([&comm] { coordinator::ServeRank(*comm); });
    return kDone;
  }
  const RankRelease release(*comm);
  CommandState state;
  state.comm = comm.get();
  state.command_line = "skyquilt";
  for (int i = 1; i < argc; ++i) state.command_line += std::string(" ") + argv[i];
  CLI::App app{"Skyquilt turns a survey of drone photos into a geo-referenced radiance field, block by block, on CPUs.", "skyquilt"};
  AddCommands(app, state, add_bench != nullptr ? add_bench : NameBench);
  const int n_parsed = ParsedWords(argc, argv);
  state.rest.assign(argv + n_parsed, argv + argc);
  int parse_status = kDone;
  const int status = Guarded([&] {
    try {
      app.parse(n_parsed, argv);
    } catch (const CLI::Success& done) {
      app.exit(done);
      state.run_command = [] {};
    } catch (const CLI::ParseError& error) {
      parse_status = ReportParseError(app, error);
    }
  });
  if (parse_status != kDone) return parse_status;
  if (status != kDone) return status;
  if (!state.run_command) {
    std::cerr << app.help();
    return kUsage;
  }
  base::InitLog(state.verbose);
  if (state.quiet) {
    base::SetLogLevel(base::LogLevel::kWarning);
    base::Progress::SetQuiet(true);
  }
  const int ended = Guarded(state.run_command);
  return state.status_for_caller ? state.status_for_caller(ended) : ended;
}

}  // namespace skyquilt::app
