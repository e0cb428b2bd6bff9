/// An allocator for vectors that do not initialise new elements. The threads that fill a large table are then
/// the first to touch its pages, and files are read straight into place. Thread safe, as std::allocator.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

namespace rfsmooth {

/// For numbers: resize() leaves the value of new elements indeterminate.
template <class T>
class Unfilled {
 public:
  using value_type = T;
  Unfilled() = default;
  template <class Other>
  Unfilled(const Unfilled<Other>&) noexcept {}

  T* allocate(std::size_t size) { return std::allocator<T>().allocate(size); }
  void deallocate(T* at, std::size_t size) noexcept { std::allocator<T>().deallocate(at, size); }

  template <class U>
  void construct(U* at) noexcept {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... From>
  void construct(U* at, From&&... from) {
    ::new (static_cast<void*>(at)) U(std::forward<From>(from)...);
  }

  friend bool operator==(const Unfilled&, const Unfilled&) { return true; }
  friend bool operator!=(const Unfilled&, const Unfilled&) { return false; }
};

}  // namespace rfsmooth
