/// What the library promises when memory runs out or the caller stops it, at any stage: an Error, and the
/// caller's data untouched. Every allocation of this program goes through the operator new below, which can
/// be told to fail at the k-th one, or to set the stop flag there (so that the stages are cancelled between
/// any two of their polls).
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <mutex>
#include <new>
#include <random>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <rfsmooth/denoise.h>
#include <rfsmooth/flow.h>

#include "base/parallel.h"
#include "pipeline/io/io.h"
#include "tests/support/awkward_clouds.h"
#include "tests/support/sanitized.h"

// With the sanitizers, GCC inlines half of a pair of new and delete and takes the other half for a stranger.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

namespace {

std::atomic<long> countdown{-1};  // -1: not armed; counts allocations down to 0
std::atomic<long> asked_for{0};
std::atomic<bool> stop_instead{false};
std::atomic<bool> stop{false};

void* allocate(std::size_t size, std::size_t alignment) {
  asked_for.fetch_add(1, std::memory_order_relaxed);
  if (countdown.load(std::memory_order_relaxed) >= 0 &&
      countdown.fetch_sub(1, std::memory_order_relaxed) == 0) {
    if (!stop_instead) throw std::bad_alloc();
    stop = true;
  }
  void* memory = alignment > alignof(std::max_align_t)
                     ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                     : std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate(size, 1);
}
void* operator new[](std::size_t size) {
  return allocate(size, 1);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, std::size_t(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocate(size, std::size_t(alignment));
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace rfsmooth {
namespace {

namespace io = pipeline::io;

/// What a call came to: nothing, or the error it returned.
using Call = std::function<std::optional<Error>(const Context&)>;

template <class T>
std::optional<Error> error_of(const Result<T>& result) {
  if (result.ok()) return std::nullopt;
  return result.error();
}

/// Makes the call fail at its 1st, 2nd, ... allocation (about a hundred of them, evenly, if there are more;
/// twenty with the sanitizers) and calls `untouched` each time. Then the same with a stop at that place.
/// `restore` brings the data back before each. `polls`: whether the call looks again after some allocation;
/// over one block of a small file it may not.
void expect_all_or_nothing(const Call& call, const std::function<void()>& restore,
                           const std::function<bool()>& untouched, bool polls = true) {
  constexpr long kTries = test::kSanitized ? 20 : 100;
  Context context;
  context.threads = 1;  // the k-th allocation is the same one every time
  context.stop = &stop;
  stop = false;
  restore();
  asked_for = 0;
  ASSERT_FALSE(call(context)) << "the call itself must succeed";
  const long all = asked_for;
  ASSERT_GT(all, 0);
  const long every = std::max(1L, all / kTries);
  for (const bool cancel : {false, true}) {
    long failed = 0;
    for (long k = 0; k < all; k += every) {
      SCOPED_TRACE((cancel ? "stopped at allocation " : "failed at allocation ") + std::to_string(k) +
                   " of " + std::to_string(all));
      restore();
      stop = false;
      stop_instead = cancel;
      countdown = k;
      std::optional<Error> error;
      try {
        error = call(context);
      } catch (const std::exception& e) {
        countdown = -1;
        FAIL() << "an exception left the front door: " << e.what();
      }
      countdown = -1;
      if (!error) continue;  // cancelled after the last poll, or an allocation that can be done without
      ++failed;
      EXPECT_EQ(int(error->code), int(cancel ? ErrorCode::cancelled : ErrorCode::out_of_memory))
          << error->message;
      EXPECT_FALSE(error->message.empty());
      ASSERT_TRUE(untouched());
    }
    EXPECT_TRUE(failed > 0 || (cancel && !polls)) << (cancel ? "never stopped" : "never failed");
  }
  stop = false;
}

std::vector<double> noisy(std::size_t n) {
  std::vector<double> xyz;
  for (const auto& p : test::noisy_sphere(n, 0.02, 5)) xyz.insert(xyz.end(), {p.x(), p.y(), p.z()});
  return xyz;
}

/// Two steps of flows that take ten by themselves.
class DenoiseFailure : public ::testing::TestWithParam<AnyFlow> {
 protected:
  static FlowOptions flow() {
    FlowOptions options{GetParam()};
    int& steps = iterations(options.flow);
    steps = std::min(steps, 2);
    return options;
  }
};

TEST_P(DenoiseFailure, LeavesTheCloudAsItWas) {
  const std::vector<double> original = noisy(120);
  std::vector<double> xyz;
  DenoiseOptions options;
  options.flow = flow();
  expect_all_or_nothing(
      [&](const Context& context) {
        return error_of(rfsmooth::denoise(xyz.data(), xyz.size() / 3, options, context));
      },
      [&] { xyz = original; }, [&] { return xyz == original; });
}

TEST_P(DenoiseFailure, OfAFlowLeavesTheMeshAsItWas) {
  const std::vector<double> xyz = noisy(120);
  Context one;  // a worker of TBB that only now starts could meet the failure where nobody can catch it
  one.threads = 1;
  const auto cloud = rfs_mesh::make_working_cloud(xyz.data(), xyz.size() / 3, one);
  const Mesh original = rfsmooth::connect(cloud.value().points, {}, one).value().mesh;
  Mesh mesh;
  const FlowOptions options = flow();
  expect_all_or_nothing(
      [&](const Context& context) { return error_of(rfsmooth::smooth(mesh, options, context)); },
      [&] { mesh = original; },
      [&] { return mesh.positions == original.positions && mesh.faces == original.faces; });
}

// The automatic flow works on other rings there for a while.
TEST(Failure, OfPointsOnLinesLeavesTheMeshAsItWas) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0, 0.4);
  Positions points;
  for (int line = 0; line < 12; ++line)
    for (int i = 0; i < 80; ++i) points.emplace_back(i, 20 * line, noise(engine));
  Context one;
  one.threads = 1;
  const Mesh original = rfsmooth::connect(points, {}, one).value().mesh;
  Mesh mesh;
  expect_all_or_nothing(
      [&](const Context& context) {
        return error_of(rfsmooth::smooth(mesh, FlowOptions{AutomaticOptions()}, context));
      },
      [&] { mesh = original; },
      [&] {
        return mesh.positions == original.positions && mesh.one_ring.start == original.one_ring.start &&
               mesh.one_ring.items == original.one_ring.items;
      });
}

INSTANTIATE_TEST_SUITE_P(Flows, DenoiseFailure, ::testing::ValuesIn(rfsmooth::flows()), [](const auto& test) {
  std::string name(name_of(test.param));
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

/// How many cores this process may use, which may be fewer than there are.
std::size_t cores() {
  cpu_set_t mask;
  CPU_ZERO(&mask);
  return sched_getaffinity(0, sizeof mask, &mask) == 0 ? std::size_t(CPU_COUNT(&mask)) : 1;
}

/// Returns when four threads (or as many as there are cores) have been at work: the start of a worker is
/// inside TBB, where nobody could catch a failure.
void start_the_workers() {
  const std::size_t wanted = std::min<std::size_t>(4, cores());
  std::set<std::thread::id> seen;
  std::mutex lock;
  Context context;
  context.threads = 4;
  const auto start = std::chrono::steady_clock::now();
  while (seen.size() < wanted && std::chrono::steady_clock::now() - start < std::chrono::seconds(20))
    in_arena(context, [&] {
      for_blocks(context, 8, 1, [&](std::size_t, std::size_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        const std::lock_guard<std::mutex> guard(lock);
        seen.insert(std::this_thread::get_id());
      });
    });
}

TEST(Failure, OfThreadsLeavesTheCloudAsItWas) {
  start_the_workers();
  // With more threads the k-th allocation is another one each time: any place will do.
  const std::vector<double> original = noisy(1000);
  for (long k = 1; k < 5000; k = k * 2 + 1) {
    std::vector<double> xyz = original;
    Context context;
    context.threads = 4;
    stop_instead = false;
    countdown = k;
    std::optional<Error> error;
    try {
      error = error_of(rfsmooth::denoise(xyz.data(), xyz.size() / 3, {}, context));
    } catch (const std::exception& e) {
      countdown = -1;
      FAIL() << "an exception left the front door: " << e.what();
    }
    countdown = -1;
    if (!error) continue;
    EXPECT_EQ(error->code, ErrorCode::out_of_memory);
    EXPECT_TRUE(xyz == original) << k;
  }
}

std::string file_of(io::Format format, io::Encoding encoding) {
  const std::vector<double> xyz = noisy(40);
  io::Cloud cloud = io::make_cloud(xyz.data(), 40, io::Scalar::float32);
  io::set_field(cloud, "mark", io::Scalar::uint8, std::vector<double>(40, 7));
  io::WriteOptions options;
  options.format = format;
  options.encoding = encoding;
  options.drop_unsupported = true;  // OFF has no other fields
  return io::serialize_cloud(cloud, options, {}).value();
}

struct Kind {
  const char* name;
  io::Format format;
  io::Encoding encoding;
};

class FileFailure : public ::testing::TestWithParam<Kind> {
 protected:
  std::string bytes() const { return file_of(GetParam().format, GetParam().encoding); }
  io::Cloud cloud() const { return io::parse_cloud(bytes(), "in", {}, {}).value(); }
  static std::string text_of(const io::Cloud& cloud) { return io::serialize_cloud(cloud, {}, {}).value(); }
};

TEST_P(FileFailure, OfReadingIsAnError) {
  const std::string in = bytes();
  expect_all_or_nothing(
      [&](const Context& context) { return error_of(io::parse_cloud(in, "in", {}, context)); }, [] {},
      [] { return true; }, false);
}

TEST_P(FileFailure, OfWritingKeepsTheOldFileAndLeavesNoOther) {
  namespace fs = std::filesystem;
  const fs::path folder =
      fs::temp_directory_path() / ("rfsmooth_failure_" + std::to_string(::getpid()) + GetParam().name);
  const fs::path out = folder / "out";
  fs::create_directories(folder);
  const io::Cloud old = io::make_cloud(noisy(3).data(), 3), written = cloud();
  io::WriteOptions options;
  options.format = GetParam().format;
  options.force = true;
  options.sync = false;
  ASSERT_TRUE(io::write_cloud(old, out, options, {}).ok());
  const auto read = [&] {
    io::ReadOptions as;
    as.format = GetParam().format;
    return io::read_cloud(out, as, {}).value();
  };
  expect_all_or_nothing(
      [&](const Context& context) { return error_of(io::write_cloud(written, out, options, context)); },
      [&] { ASSERT_TRUE(io::write_cloud(old, out, options, {}).ok()); },
      [&] {
        return std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 1 &&
               read().size() == 3;
      });
  fs::remove_all(folder);
}

TEST_P(FileFailure, OfChangingACloudLeavesItAsItWas) {
  const io::Cloud original = cloud();
  const std::string before = text_of(original);
  std::vector<double> xyz = io::positions(original);
  for (double& v : xyz) v += 0.125;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < original.size(); i += 2) rows.push_back(i);
  io::Cloud changed;
  const std::function<void(const Context&)> changes[] = {
      [&](const Context& context) { io::set_positions(changed, xyz.data(), context); },
      [&](const Context& context) {
        io::set_field(changed, "new", io::Scalar::float32, std::vector<double>(changed.size(), 1.5), context);
      },
      [&](const Context& context) { io::select_points(changed, rows, context); }};
  for (const auto& change : changes)
    expect_all_or_nothing(
        [&](const Context& context) {
          return error_of(guarded([&] {
            change(context);
            return Done{};
          }));
        },
        [&] { changed = original; }, [&] { return text_of(changed) == before; }, false);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, FileFailure,
    ::testing::Values(Kind{"PlyAscii", io::Format::ply, io::Encoding::ascii},
                      Kind{"PlyBinary", io::Format::ply, io::Encoding::binary_little_endian},
                      Kind{"PcdAscii", io::Format::pcd, io::Encoding::ascii},
                      Kind{"PcdBinary", io::Format::pcd, io::Encoding::binary_little_endian},
                      Kind{"PcdCompressed", io::Format::pcd, io::Encoding::binary_compressed},
                      Kind{"Xyz", io::Format::xyz, io::Encoding::ascii},
                      Kind{"Off", io::Format::off, io::Encoding::ascii}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace rfsmooth
