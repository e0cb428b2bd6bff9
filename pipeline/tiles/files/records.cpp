#include "pipeline/tiles/files/records.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <utility>

namespace rfsmooth::pipeline::tiles {

namespace {

constexpr std::uint64_t kMark = 0x31656c6974736672;  // "rfstile1"
constexpr std::size_t kHeld = 1024;                  // records, 32 KB
constexpr std::uint64_t kHashStart = 0xcbf29ce484222325;

/// Fowler, Noll and Vo's hash 1a, by words of eight bytes.
template <class T>
std::uint64_t hashed(std::uint64_t hash, const T* records, std::size_t count) {
  std::array<std::uint64_t, sizeof(T) / sizeof(std::uint64_t)> words{};
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(words.data(), records + i, sizeof words);
    for (const std::uint64_t word : words) hash = ((hash ^ word) * 0x100000001b3) ^ (hash >> 47);
  }
  return hash;
}

struct Trailer {
  std::uint64_t mark = 0, count = 0, hash = 0;
};
static_assert(sizeof(Trailer) == 24);

/// If it is one, and the file has the size that it tells.
template <class T>
std::optional<Trailer> trailer_of(const io::Source& source, const Context& context) {
  Trailer trailer{};
  if (source.size() < sizeof trailer) return std::nullopt;
  const std::uint64_t records = source.size() - sizeof trailer;
  source.read(records, reinterpret_cast<char*>(&trailer), sizeof trailer, context);
  if (trailer.mark != kMark || records % sizeof(T) != 0 || trailer.count != records / sizeof(T))
    return std::nullopt;
  return trailer;
}

}  // namespace

void append_places(const std::vector<Record>& points, std::vector<double>& xyz) {
  for (const Record& r : points) xyz.insert(xyz.end(), {r.x, r.y, r.z});
}

template <class T>
WriterOf<T>::WriterOf(const std::filesystem::path& path, const Context& context)
    : file_(path, true, context), hash_(kHashStart) {}

template <class T>
void WriterOf<T>::add(const T& record) {
  held_.push_back(record);
  if (held_.size() == kHeld) flush();
}

template <class T>
void WriterOf<T>::flush() {
  hash_ = hashed(hash_, held_.data(), held_.size());
  count_ += held_.size();
  file_.write({reinterpret_cast<const char*>(held_.data()), held_.size() * sizeof(T)});
  held_.clear();
}

template <class T>
void WriterOf<T>::commit() {
  flush();
  const Trailer trailer = {kMark, count_, hash_};
  file_.write({reinterpret_cast<const char*>(&trailer), sizeof trailer});
  file_.commit(true);
}

template <class T>
ReaderOf<T>::ReaderOf(std::filesystem::path path, const Context& context)
    : path_(std::move(path)), context_(context) {
  const io::Source source(path_, context_);
  const auto trailer = trailer_of<T>(source, context_);
  if (!trailer) source.fail("is not complete; the step that makes it makes it again");
  count_ = trailer->count;
}

template <class T>
void ReaderOf<T>::skip_to(std::uint64_t row) {
  static_assert(offsetof(T, row) == 0);
  const io::Source source(path_, context_);
  std::uint64_t end = count_;
  while (at_ < end) {
    const std::uint64_t middle = at_ + (end - at_) / 2;
    std::uint64_t there = 0;
    source.read(middle * sizeof(T), reinterpret_cast<char*>(&there), sizeof there, context_);
    if (there < row)
      at_ = middle + 1;
    else
      end = middle;
  }
  from_ = at_;
  held_.clear();
}

template <class T>
const T* ReaderOf<T>::peek() {
  if (at_ == count_) return nullptr;
  if (at_ == from_ + held_.size()) {
    // Opened for every buffer: there may be more tiles than a process may have files open.
    from_ = at_;
    held_.resize(std::size_t(std::min<std::uint64_t>(kHeld, count_ - at_)));
    io::Source(path_, context_)
        .read(from_ * sizeof(T), reinterpret_cast<char*>(held_.data()), held_.size() * sizeof(T), context_);
  }
  return &held_[std::size_t(at_ - from_)];
}

template <class T>
std::optional<std::uint64_t> complete_records(const std::filesystem::path& path, const Context& context) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const io::Source source(path, context);
  const auto trailer = trailer_of<T>(source, context);
  if (!trailer) return std::nullopt;
  std::uint64_t hash = kHashStart;
  std::vector<T> part;
  for (std::uint64_t at = 0; at < trailer->count; at += part.size()) {
    part.resize(std::size_t(std::min<std::uint64_t>(kHeld, trailer->count - at)));
    source.read(at * sizeof(T), reinterpret_cast<char*>(part.data()), part.size() * sizeof(T), context);
    hash = hashed(hash, part.data(), part.size());
  }
  return hash == trailer->hash ? std::optional(trailer->count) : std::nullopt;
}

std::vector<Record> read_records(const std::filesystem::path& path, const Context& context) {
  RecordReader reader(path, context);
  std::vector<Record> all;
  all.reserve(std::size_t(reader.size()));
  for (; const Record* record = reader.peek(); reader.next()) all.push_back(*record);
  return all;
}

template class WriterOf<Record>;
template class ReaderOf<Record>;
template class WriterOf<NormalRecord>;
template class ReaderOf<NormalRecord>;
template std::optional<std::uint64_t> complete_records<Record>(const std::filesystem::path&, const Context&);
template std::optional<std::uint64_t> complete_records<NormalRecord>(const std::filesystem::path&,
                                                                     const Context&);

}  // namespace rfsmooth::pipeline::tiles
