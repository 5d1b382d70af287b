// `skyquilt view`: a project in the browser.
#pragma once

#include <optional>
#include <string>

#include "coordinator/project/project.h"
#include "coordinator/project/run_options.h"
#include "core/comm/communicator.h"

namespace skyquilt::viewer {

struct ViewOptions {
  coordinator::Project project;
  std::optional<coordinator::Project> before;
  std::string listen;  // empty: 127.0.0.1
  int port = 0;        // 0: a free one
  std::string exposure = "normal";
  bool plain_surround = true;
  std::string front_end;  // folder with the files of the front end; empty: those in the program
  coordinator::RunOptions run;
  bool edit = false;  // the tour may be changed, by whoever opens the link for that
  bool verbose = false, quiet = false;
};

// Prints the link, or the two links to edit and to play, and serves until it is interrupted, which is its normal end. Throws base::UsageError,
// base::InputError.
void View(comm::Communicator& comm, const ViewOptions& options);

}  // namespace skyquilt::viewer
