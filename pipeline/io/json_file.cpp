#include "pipeline/io/json_file.h"

#include <string_view>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/io/stream/source.h"

namespace rfsmooth::pipeline::io {

using nlohmann::ordered_json;

ordered_json read_json(const std::filesystem::path& path) {
  const Source source(path, {});
  const Bytes text = source.read(0, std::size_t(source.size()), {});
  try {
    return ordered_json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::parse_error& error) {
    fail(ErrorCode::input_unreadable, "{}: not JSON at byte {}", path.string(), error.byte);
  } catch (const nlohmann::json::exception&) {  // the one other thing that goes wrong in reading
    fail(ErrorCode::usage, "{}: a number in it is too large", path.string());
  }
}

std::string said_of(const nlohmann::json::exception& error) {
  constexpr int kNoKey = 403;  // of nlohmann::json's exceptions: "... key 'NAME' not found"
  const std::string_view what = error.what();
  const std::size_t first = what.find('\''), last = what.rfind('\'');
  if (error.id == kNoKey && first < last)
    return fmt::format("the key '{}' is missing", what.substr(first + 1, last - first - 1));
  return "a value in it is of another kind than rfsmooth writes";
}

std::string in_lines(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + '\n';
}

}  // namespace rfsmooth::pipeline::io
