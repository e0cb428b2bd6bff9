/// An allocator whose vectors do not fill new elements: large tables are first touched by the threads that
/// write them, side by side.
#pragma once

#include <memory>
#include <new>
#include <utility>

namespace rfsmooth::rfs_mesh {

/// For numbers: after resize() new elements hold anything.
template <class T>
struct Unfilled : std::allocator<T> {
  template <class Other>
  struct rebind {
    using other = Unfilled<Other>;
  };
  Unfilled() = default;
  template <class Other>
  Unfilled(const Unfilled<Other>& other) noexcept : std::allocator<T>(other) {}

  template <class U>
  void construct(U* at) noexcept {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... From>
  void construct(U* at, From&&... from) {
    ::new (static_cast<void*>(at)) U(std::forward<From>(from)...);
  }
};

}  // namespace rfsmooth::rfs_mesh
