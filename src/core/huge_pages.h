// Allocator for large, randomly read arrays; uses huge pages where available.
//
// Arrays of 2 MiB and more are aligned to huge pages, and the kernel is advised to use them; otherwise a
// random read in 64 MB of small pages waits for the page table as well as for the memory. Without huge pages
// only the speed changes. Every array begins on a cache line.
#pragma once

#include <cstddef>
#include <vector>

namespace intaglio {

void* allocate_on_huge_pages(std::size_t bytes);  // throws std::bad_alloc
void free_huge_pages(void* memory);

template <class T>
struct HugePageAllocator {
  using value_type = T;

  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) {}

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_on_huge_pages(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t) { free_huge_pages(memory); }
  friend bool operator==(const HugePageAllocator&, const HugePageAllocator&) { return true; }
};

template <class T>
using LargeArray = std::vector<T, HugePageAllocator<T>>;

}  // namespace intaglio
