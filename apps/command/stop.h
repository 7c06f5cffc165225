// How the command is stopped: by SIGINT, SIGTERM or SIGHUP, and by SIGPIPE when the reader of its output has
// gone (docs/trust.md).
//
// The first signal wakes a thread that ends the process, wherever the other threads are: it kills the
// children, waits for a set of files that is being put in place, removes the temporaries, prints a line and
// exits with 128 + the signal. A verb that has something to finish polls `interrupted` instead, and is ended
// like any other if it takes too long. A second signal ends the process at once.
//
// Any thread.
#pragma once

#include <atomic>

namespace intaglio::app {

// Called first in main().
void watch_for_stop();

// Set by the first signal.
extern std::atomic<bool> interrupted;
// 128 + the first signal.
int interrupted_code();

// From here on a signal leaves the process 0.3 s in which to end by itself.
void end_gracefully();
// From here on nothing is printed about a stop.
void stop_quietly();
// Ends the process with this code 0.3 s after the first call, unless it has ended by then: for a verb that
// has only to clean up.
void end_soon(int code);

// Never returns once the process is being ended: so that the main thread neither reports what the stop has
// done to its work nor ends first, with another code.
void wait_if_stopped();

}  // namespace intaglio::app
