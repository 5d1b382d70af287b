// Owners of PROJ's objects. A context and all that was made in it belong to one thread at a time.
#pragma once

#include <proj.h>

#include <memory>

namespace skyquilt::geo {

struct FreeProjContext {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct FreeProjObject {
  void operator()(PJ* object) const { proj_destroy(object); }
};
using ProjContext = std::unique_ptr<PJ_CONTEXT, FreeProjContext>;
using ProjObject = std::unique_ptr<PJ, FreeProjObject>;

// Reports errors by codes alone, not on standard error.
inline ProjContext QuietProjContext() {
  ProjContext context(proj_context_create());
  proj_log_level(context.get(), PJ_LOG_NONE);
  return context;
}

}  // namespace skyquilt::geo
