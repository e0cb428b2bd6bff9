#include "pipeline/io/formats/lzf.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace rfsmooth::pipeline::io {
namespace {

constexpr std::size_t kMostLiterals = 32, kMostReach = 8192, kLeastMatch = 3, kMostMatch = 264;
constexpr int kHashBits = 16;

std::uint32_t hash_of(const unsigned char* p) {
  const std::uint32_t v = std::uint32_t(p[0]) | std::uint32_t(p[1]) << 8 | std::uint32_t(p[2]) << 16;
  return (v * 2654435761u) >> (32 - kHashBits);
}

// How many bytes at a and b agree, at most `most`; b < a, and both may be read up to a + most.
std::size_t match_length(const unsigned char* a, const unsigned char* b, std::size_t most) {
  std::size_t n = 0;
  while (n + 8 <= most) {
    std::uint64_t x, y;
    std::memcpy(&x, a + n, 8);
    std::memcpy(&y, b + n, 8);
    if (x != y) return n + std::size_t(__builtin_ctzll(x ^ y)) / 8;
    n += 8;
  }
  while (n < most && a[n] == b[n]) ++n;
  return n;
}

}  // namespace

Bytes lzf_compress(std::string_view in) {
  const auto* const first = reinterpret_cast<const unsigned char*>(in.data());
  const std::size_t n = in.size();
  Bytes out(n + n / kMostLiterals + 2);
  auto* o = reinterpret_cast<unsigned char*>(out.data());
  std::vector<std::uint64_t> seen(std::size_t{1} << kHashBits, 0);  // position + 1; 0 = none

  std::size_t literals = 0;  // first literal not yet written
  const auto flush = [&](std::size_t to) {
    while (literals < to) {
      const std::size_t run = std::min(kMostLiterals, to - literals);
      *o++ = static_cast<unsigned char>(run - 1);
      std::memcpy(o, first + literals, run);
      o += run;
      literals += run;
    }
  };
  std::size_t i = 0;
  while (i + kLeastMatch <= n) {
    std::uint64_t& slot = seen[hash_of(first + i)];
    const std::uint64_t candidate = slot;
    slot = i + 1;
    if (candidate == 0 || i - (candidate - 1) > kMostReach) {
      ++i;
      continue;
    }
    const std::size_t back = std::size_t(candidate - 1);
    const std::size_t length = match_length(first + i, first + back, std::min(kMostMatch, n - i));
    if (length < kLeastMatch) {
      ++i;
      continue;
    }
    flush(i);
    const std::size_t distance = i - back - 1;
    const std::size_t code = length - 2;
    if (code < 7) {
      *o++ = static_cast<unsigned char>((code << 5) | (distance >> 8));
    } else {
      *o++ = static_cast<unsigned char>((7u << 5) | (distance >> 8));
      *o++ = static_cast<unsigned char>(code - 7);
    }
    *o++ = static_cast<unsigned char>(distance & 255);
    // Remember the match's end, where the next one is likely to start from.
    for (std::size_t k = i + length - 2; k < i + length; ++k)
      if (k + kLeastMatch <= n) seen[hash_of(first + k)] = k + 1;
    i += length;
    literals = i;
  }
  flush(n);
  out.resize(std::size_t(o - reinterpret_cast<unsigned char*>(out.data())));
  return out;
}

LzfOutcome lzf_decompress(std::string_view in, char* out, std::size_t size) {
  const auto* const first = reinterpret_cast<const unsigned char*>(in.data());
  const unsigned char* p = first;
  const unsigned char* const end = p + in.size();
  char* o = out;
  char* const stop = out + size;
  const auto fail = [&](const char* what) { return LzfOutcome{false, std::size_t(p - first), what}; };
  while (p < end) {
    const unsigned code = *p;
    if (code < 32) {
      const std::size_t run = code + 1;
      if (std::size_t(end - p) < run + 1) return fail("a run of literals goes beyond the end of the stream");
      if (std::size_t(stop - o) < run) return fail("the stream holds more than the header says");
      std::memcpy(o, p + 1, run);
      o += run;
      p += run + 1;
      continue;
    }
    std::size_t length = code >> 5;
    const std::size_t bytes = length == 7 ? 3 : 2;
    if (std::size_t(end - p) < bytes) return fail("a reference goes beyond the end of the stream");
    if (length == 7) length += p[1];
    length += 2;
    const std::size_t distance = (std::size_t(code & 31) << 8) + p[bytes - 1] + 1;
    if (distance > std::size_t(o - out)) return fail("a reference points before the start of the data");
    if (std::size_t(stop - o) < length) return fail("the stream holds more than the header says");
    const char* from = o - distance;
    if (distance >= length) {
      std::memcpy(o, from, length);
    } else {
      for (std::size_t k = 0; k < length; ++k) o[k] = from[k];  // overlaps on purpose: repeats a pattern
    }
    o += length;
    p += bytes;
  }
  if (o != stop) return fail("the stream holds less than the header says");
  return {};
}

}  // namespace rfsmooth::pipeline::io
