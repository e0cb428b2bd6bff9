/// Where written bytes go: a file or a buffer.
#pragma once

#include <string>
#include <string_view>

namespace rfsmooth::pipeline::io {

/// Where a writer puts its bytes.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void write(std::string_view bytes) = 0;
};

/// Keeps what is written in memory.
class BufferSink : public Sink {
 public:
  void write(std::string_view bytes) override { buffer.append(bytes); }
  std::string buffer;
};

}  // namespace rfsmooth::pipeline::io
