// Counts pthread_mutex_lock() in a test program, for code that must not lock. Under sanitizers, which have
// wrappers of their own, the count stays 0.
#pragma once

#include <cstddef>

std::size_t locks();
