/// An array that does not initialise its elements. The threads that fill a large array are then the first to
/// touch its pages, each its own part. clear() and resize() keep the memory. Unlike a vector (unfilled.h),
/// one that grows by a little takes a little more memory, not twice as much: patches grow so, and are what a
/// large cloud needs most memory for. Thread safety as of std::vector.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

namespace rfsmooth {

/// An array of numbers, or of plain structs of numbers.
template <class T>
class RawArray {
 public:
  RawArray() = default;
  explicit RawArray(std::size_t size) { resize(size); }

  /// Keeps the old elements that fit; the value of new ones is indeterminate.
  void resize(std::size_t size) {
    if (size > capacity_) {
      const std::size_t room = size + size / 32;  // slightly larger sizes often follow
      if (size_ == 0) {                           // never the memory of both
        items_.reset();
        capacity_ = 0;
      }
      std::unique_ptr<T[]> larger(new T[room]);
      std::copy(items_.get(), items_.get() + size_, larger.get());
      items_ = std::move(larger);
      capacity_ = room;
    }
    size_ = size;
  }

  /// No elements; the memory stays.
  void clear() { size_ = 0; }

  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return items_[i]; }
  const T& operator[](std::size_t i) const { return items_[i]; }
  T* data() { return items_.get(); }
  const T* data() const { return items_.get(); }

 private:
  std::unique_ptr<T[]> items_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace rfsmooth
