// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <tests/observer/allocation_counter.hpp>

namespace palpate::test {

namespace {
thread_local bool counting = false;
thread_local std::size_t allocations = 0;
}  // namespace

CountAllocations::CountAllocations() {
  allocations = 0;
  counting = true;
}

CountAllocations::~CountAllocations() { counting = false; }

std::size_t CountAllocations::so_far() const { return allocations; }

namespace {

void note_allocation() {
  if (counting) ++allocations;
}

}  // namespace
}  // namespace palpate::test

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // g++ says it so, clang by __has_feature
#define PALPATE_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PALPATE_SANITIZED
#endif
#endif

#ifdef PALPATE_SANITIZED

// A sanitizer owns malloc and operator new, and tells of every call of either.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                                         void (*on_free)(const volatile void*));

namespace {
const bool installed =
    __sanitizer_install_malloc_and_free_hooks(
        [](const volatile void*, std::size_t) { palpate::test::note_allocation(); }, [](const volatile void*) {}) != 0;
}  // namespace

#else

// The program's malloc comes before libc's; operator new and Eigen's aligned allocation end up here. glibc exports its
// own under these names for that purpose.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  palpate::test::note_allocation();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  palpate::test::note_allocation();
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  palpate::test::note_allocation();
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  palpate::test::note_allocation();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  *out = memalign(alignment, size);
  return *out == nullptr ? 12 : 0;  // ENOMEM
}
}

#endif
