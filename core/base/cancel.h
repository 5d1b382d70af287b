// Asking a long run to stop at its next safe point. SIGINT, SIGTERM and SIGUSR1 (a batch system's warning) set the flag;
// a second SIGINT ends the process at once.
#pragma once

namespace skyquilt::base {

void InstallSignalHandlers();
bool CancelRequested();
void RequestCancel();
// Takes RequestCancel back, but no signal.
void WithdrawRequest();
// Forgets both.
void ClearCancel();
// Throws Interrupted when the flag is set.
void ThrowIfCancelled();

}  // namespace skyquilt::base
