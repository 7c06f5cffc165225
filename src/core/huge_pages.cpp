#include "core/huge_pages.h"

#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace intaglio {

void* allocate_on_huge_pages(std::size_t bytes) {
  constexpr std::size_t huge_page = std::size_t{1} << 21, line = 64;
  const bool huge = bytes >= huge_page;
  const std::size_t unit = huge ? huge_page : line;
  if (bytes > PTRDIFF_MAX - unit) throw std::bad_alloc();
  void* memory = std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit);
  if (memory == nullptr) throw std::bad_alloc();
  if (huge) madvise(memory, bytes, MADV_HUGEPAGE);
  return memory;
}

void free_huge_pages(void* memory) {
  std::free(memory);
}

}  // namespace intaglio
