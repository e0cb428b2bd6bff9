/// What the programs of this folder measure, and the line that each figure is printed in.
#pragma once

#include <cstddef>
#include <cstdio>
#include <ctime>
#include <initializer_list>
#include <string>

namespace rfsmooth::bench {

/// Processor time from its making on.
class Stopwatch {
 public:
  double seconds() const { return double(std::clock() - start_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t start_ = std::clock();
};

/// A cloud's name where its noise is so many times as large as usual.
inline std::string times_as_loud(const std::string& cloud, double times) {
  std::string name(32, '\0');
  name.resize(std::size_t(std::snprintf(name.data(), name.size(), "*%g", times)));
  return cloud + name;
}

/// A line of the output: kind (laws, normals, strays, further), shape or sensor, cloud, seconds, figures.
inline void print_row(const char* kind, const std::string& of, const std::string& cloud, double seconds,
                      std::initializer_list<double> figures) {
  std::printf("%s %s %s %.3f", kind, of.c_str(), cloud.c_str(), seconds);
  for (const double figure : figures) std::printf(" %.10g", figure);
  std::printf("\n");
}

}  // namespace rfsmooth::bench
