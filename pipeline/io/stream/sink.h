/// Where a writer puts its bytes: a file or a buffer.
#pragma once

#include <string>
#include <string_view>

namespace rfsmooth::pipeline::io {

/// The interface of all targets.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void write(std::string_view bytes) = 0;
};

/// Collects the bytes in memory.
class BufferSink : public Sink {
 public:
  void write(std::string_view bytes) override { buffer.append(bytes); }
  std::string buffer;
};

}  // namespace rfsmooth::pipeline::io
