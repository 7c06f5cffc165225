// Counts calls of operator new in a test program, for code that must not allocate, or not as much as a file
// claims. Programs that do not call these keep their own operator new.
#pragma once

#include <cstddef>

// Calls by this thread so far.
std::size_t allocations();
// The largest single request since the last forget_allocations(), bytes.
std::size_t largest_allocation();
void forget_allocations();
// Bytes that all threads hold now.
std::size_t held_bytes();
