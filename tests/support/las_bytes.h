/// LAS files written by hand, byte by byte as the specification has them (ASPRS LAS 1.4 R15), not with the
/// code that is tested.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace rfsmooth::test {

/// A file with everything that may stand in one: VLRs, a gap before the points, extra bytes with and without
/// a description, EVLRs, waveforms, bytes at the end.
struct LasBytes {
  int minor = 4, format = 6;
  std::array<double, 3> scale{0.01, 0.01, 0.001}, offset{500000, 4649000, 0};
  std::vector<std::array<std::int32_t, 3>> xyz;  ///< what is stored
  std::size_t described = 5,
              undescribed = 3;         ///< extra bytes: a float64-free pair (uint8, float32) and some more
  bool records = true, behind = true;  ///< VLRs and a gap; EVLRs and bytes at the end
  bool legacy = true;                  ///< 1.4, formats 0 to 5: fill in the old counts too

  static constexpr std::size_t kStandard[11] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

  std::size_t header() const { return minor < 3 ? 227 : minor < 4 ? 235 : 375; }
  std::size_t row() const { return kStandard[format] + described + undescribed; }
  bool has_waves() const { return format == 4 || format == 5 || format >= 9; }
  std::size_t points() const { return header() + head().size(); }
  std::size_t end() const { return points() + row() * xyz.size(); }

  /// The return number of a point: 0 (none) to 5 in turn.
  static std::uint8_t nth(std::size_t i) { return std::uint8_t(i % 6); }

  template <class T>
  static void add(std::string& out, T value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  static void put(std::string& out, std::size_t at, T value) {
    std::memcpy(out.data() + at, &value, sizeof value);
  }
  template <class T>
  static T get(const std::string& in, std::size_t at) {
    T value;
    std::memcpy(&value, in.data() + at, sizeof value);
    return value;
  }

  std::string record(const std::string& user, std::uint16_t id, const std::string& body,
                     bool extended) const {
    std::string out;
    add<std::uint16_t>(out, minor == 0 ? 0xaabb : 0);
    out += user + std::string(16 - user.size(), '\0');
    add(out, id);
    if (extended)
      add<std::uint64_t>(out, body.size());
    else
      add(out, std::uint16_t(body.size()));
    return out + "described by hand" + std::string(15, '\0') + body;
  }
  static std::string description(const std::string& name, std::uint8_t type) {
    std::string out(192, '\0');
    out[2] = char(type);
    out.replace(4, name.size(), name);
    return out;
  }
  std::vector<std::string> vlrs() const {
    std::vector<std::string> all;
    if (records) all.push_back(record("LASF_Projection", 2112, "PROJCS[\"somewhere\"]", false));
    if (described > 0)
      all.push_back(record("LASF_Spec", 4, description("ring", 1) + description("range", 9), false));
    if (records) all.push_back(record("a company", 77, std::string("\0\1\2\xff", 4), false));
    return all;
  }
  std::string head() const {
    std::string out;
    for (const std::string& r : vlrs()) out += r;
    return out + (records ? std::string("\xdd\xcc gap", 6) : "");
  }
  std::string waves() const {
    std::string body;
    for (int k = 0; k < 40; ++k) body += char(k * 7);
    return record("LASF_Spec", 65535, body, true);
  }
  std::string tail() const {
    if (!behind) return "";
    std::string out = "between";
    if (minor >= 3 && has_waves()) out += waves();
    if (minor >= 4) out += record("copyist", 9, "long after the points", true);
    return out + "bytes at the end";
  }

  std::string point(std::size_t i) const {
    std::string out;
    for (const std::int32_t v : xyz[i]) add(out, v);
    add(out, std::uint16_t(i * 37));
    const bool extended = format >= 6;
    add(out, std::uint8_t(nth(i) | (extended ? 5 << 4 : 5 << 3 | 1 << 6)));
    add(out, std::uint8_t(extended ? 0x52 : 0xa2));  // flags; or class 2, key point no, synthetic, withheld
    add(out, std::uint8_t(extended ? 200 : 0xf5));   // class; or scan angle -11
    add(out, std::uint8_t(i % 251));                 // user data
    if (extended) add(out, std::int16_t(-4000));     // -24 degrees
    add(out, std::uint16_t(4242));
    if (format != 0 && format != 2) add(out, 1.25e8 + double(i) * 1e-4);
    if (format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10)
      for (const int c : {11, 22, 33}) add(out, std::uint16_t(c * 1001 + int(i)));
    if (format == 8 || format == 10) add(out, std::uint16_t(60000));
    if (has_waves()) {
      add(out, std::uint8_t(1));
      add(out, std::uint64_t(60));
      add(out, std::uint32_t(40));
      for (const float v : {0.5f, 1.f, 2.f, 3.f}) add(out, v);
    }
    if (described > 0) {
      add(out, std::uint8_t(i * 3));
      add(out, float(i) * 0.37f);
    }
    for (std::size_t k = 0; k < undescribed; ++k) add(out, std::uint8_t(k * 50 + i));
    return out;
  }

  std::string bytes() const {
    std::string out(header(), '\0');
    out.replace(0, 4, "LASF");
    put<std::uint16_t>(out, 4, 99);  // file source
    put<std::uint16_t>(out, 6, std::uint16_t((format >= 6 ? 16 : 1) | (has_waves() && minor >= 3 ? 2 : 0)));
    for (int k = 8; k < 24; ++k) out[std::size_t(k)] = char(k * 11);  // GUID
    out[24] = 1;
    out[25] = char(minor);
    out.replace(26, 12, "a test's own");
    put<std::uint16_t>(out, 90, 123);
    put<std::uint16_t>(out, 92, 2026);
    put<std::uint16_t>(out, 94, std::uint16_t(header()));
    put<std::uint32_t>(out, 96, std::uint32_t(points()));
    put<std::uint32_t>(out, 100, std::uint32_t(vlrs().size()));
    out[104] = char(format);
    put<std::uint16_t>(out, 105, std::uint16_t(row()));
    put_counts(out);
    for (std::size_t k = 0; k < 3; ++k) {
      put(out, 131 + 8 * k, scale[k]);
      put(out, 155 + 8 * k, offset[k]);
      std::int32_t low = xyz.empty() ? 0 : xyz[0][k], high = low;
      for (const auto& p : xyz) {
        low = std::min(low, p[k]);
        high = std::max(high, p[k]);
      }
      put(out, 179 + 16 * k, high * scale[k] + offset[k]);
      put(out, 187 + 16 * k, low * scale[k] + offset[k]);
    }
    const std::size_t waves_at = end() + 7;
    if (behind && minor >= 3 && has_waves()) put<std::uint64_t>(out, 227, waves_at);
    if (behind && minor >= 4) {
      put<std::uint64_t>(out, 235, waves_at);
      put<std::uint32_t>(out, 243, has_waves() ? 2 : 1);
    }
    out += head();
    for (std::size_t i = 0; i < xyz.size(); ++i) out += point(i);
    return out + tail();
  }

 private:
  void put_counts(std::string& out) const {
    std::array<std::uint64_t, 15> by_return{};
    for (std::size_t i = 0; i < xyz.size(); ++i)
      if (nth(i) > 0) ++by_return[nth(i) - 1u];
    if (minor < 4 || (legacy && format < 6)) {
      put(out, 107, std::uint32_t(xyz.size()));
      for (std::size_t k = 0; k < 5; ++k) put(out, 111 + 4 * k, std::uint32_t(by_return[k]));
    }
    if (minor < 4) return;
    put(out, 247, std::uint64_t(xyz.size()));
    for (std::size_t k = 0; k < 15; ++k) put(out, 255 + 8 * k, by_return[k]);
  }
};

/// n points of it, well apart.
inline LasBytes las_bytes(int minor, int format, std::size_t n) {
  LasBytes las;
  las.minor = minor;
  las.format = format;
  for (std::size_t i = 0; i < n; ++i)
    las.xyz.push_back({std::int32_t(1000 * i), std::int32_t(700 - 13 * i), std::int32_t(i * i) - 20});
  return las;
}

/// The versions and point formats that go together.
inline std::vector<std::pair<int, int>> las_kinds() {
  std::vector<std::pair<int, int>> kinds;
  for (int format = 0; format <= 10; ++format)
    for (int minor = format >= 6 ? 4 : format >= 4 ? 3 : format >= 2 ? 2 : 0; minor <= 4; ++minor)
      kinds.emplace_back(minor, format);
  return kinds;
}

}  // namespace rfsmooth::test
