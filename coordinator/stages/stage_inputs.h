// What the stages depend on besides their options, by name. Files count by path, size and time, or by their content where that is said; what only
// some surveys have, or have otherwise than by default, is left out for all others, so that records of older programs stay valid.
#pragma once

#include <string>
#include <vector>

#include "coordinator/stages/pipeline.h"

namespace skyquilt::coordinator {

std::string SurveyIdentity(const Project& project);
// With the masks that stage "masks" made, for stages that use them. Throws base::InputError when these are asked for and not there.
std::string MaskedSurveyIdentity(const Pipeline& pipeline);

// Options of "prepare" that are in PrepareInputs instead.
std::vector<std::string> OptionsAmongInputs();
FlatOptions PrepareInputs(const Pipeline& pipeline);
FlatOptions ProductInputs(const Pipeline& pipeline);
FlatOptions SurfaceInputs(const Pipeline& pipeline);
// Network and ignored ground by their content. Throws base::InputError for files that are not there, before earlier results are removed.
FlatOptions MaskInputs(const Pipeline& pipeline);
// Of the file with known outlines; empty: none is given. Throws as MaskInputs does.
std::string FootprintsIdentity(const Pipeline& pipeline);

}  // namespace skyquilt::coordinator
