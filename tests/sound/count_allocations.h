// Counts calls of operator new in this test program, for code that must not allocate.
#pragma once

#include <cstddef>

std::size_t allocations();
