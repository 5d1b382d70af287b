// Lets a long run stop at its next safe point, after it has saved its work. A process-wide flag asks for it: RequestCancel sets it, and so do SIGINT,
// SIGTERM and SIGUSR1 (which batch systems send shortly before they kill a job). A second SIGINT ends the process at once with status 130.
#pragma once

namespace skyquilt::base {

void InstallSignalHandlers();
bool CancelRequested();
void RequestCancel();
// Undoes RequestCancel; a flag set by a signal stays set.
void WithdrawRequest();
// Clears the flag, whoever set it, and forgets earlier SIGINTs.
void ClearCancel();
// Throws Interrupted when the flag is set.
void ThrowIfCancelled();

}  // namespace skyquilt::base
