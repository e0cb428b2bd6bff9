/// A growable buffer whose new bytes are not zeroed first: files are read straight into it.
#pragma once

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace rfsmooth::pipeline::io {

/// Allocator that default-initialises (leaves bytes as they are) instead of value-initialising.
template <class T>
struct DefaultInit : std::allocator<T> {
  template <class U>
  /// For containers of another type.
  struct rebind {  // NOLINT(readability-identifier-naming): the standard's name
    using other = DefaultInit<U>;
  };
  DefaultInit() = default;
  template <class U>
  DefaultInit(const DefaultInit<U>&) noexcept {}  // NOLINT(google-explicit-constructor)
  template <class U>
  void construct(U* p) noexcept {
    ::new (static_cast<void*>(p)) U;
  }
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};

/// Bytes that are not cleared first.
using Bytes = std::vector<char, DefaultInit<char>>;

}  // namespace rfsmooth::pipeline::io
