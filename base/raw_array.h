/// An array whose elements are not filled before they are written: large ones are first touched by the
/// threads that write them, side by side, and memory is kept from one use to the next.
/// As std::vector: one thread changes it, or several read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

namespace rfsmooth {

/// For plain numbers and structs of them.
template <class T>
class RawArray {
 public:
  RawArray() = default;
  explicit RawArray(std::size_t size) { resize(size); }

  /// Keeps what fits of the old elements; new ones hold anything.
  void resize(std::size_t size) {
    if (size > capacity_) {
      const std::size_t room = size + size / 32;  // a little more is often asked for soon
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
