#include <cstring>
#include <string_view>

#include "drive_log/drive_log.hpp"
#include "drive_streams/drive_streams.hpp"
#include "formats/bad_input.hpp"
#include "formats/whole_file.hpp"

namespace curbline::tools {
namespace {

using Layout = drive_log::Result<0>;

template <typename T>
T value_at(std::string_view bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

MapCurb curb_at(std::string_view bytes, std::size_t at) {
  const auto f = [&](std::size_t k) { return static_cast<double>(value_at<float>(bytes, at + k * sizeof(float))); };
  const auto kind = static_cast<CurbKind>(value_at<std::uint16_t>(bytes, at + 9 * sizeof(float)));
  return {f(0), f(1), f(2), f(3), f(4), f(5), f(6), to_string(kind)};
}

}  // namespace

std::vector<MapCurb> read_last_curbs(const std::string& path) {
  const std::string bytes = read_whole(path, 4096, "results of a drive");
  if (bytes.empty()) throw BadInput(path + ": empty; expected results of a drive");
  std::vector<MapCurb> curbs;
  for (std::size_t at = 0; at < bytes.size();) {
    const auto cut = [&](std::size_t needed) {
      if (bytes.size() - at < needed) throw BadInput(path + ": a result is cut; expected results of a drive");
    };
    cut(sizeof(drive_log::RecordHeader));
    const auto header = value_at<drive_log::RecordHeader>(bytes, at);
    at += sizeof header;
    cut(header.bytes);
    if (header.kind != drive_log::RecordKind::result || header.bytes < Layout::curbs_at ||
        (header.bytes - Layout::curbs_at) % Layout::curb_bytes != 0) {
      throw BadInput(path + ": not a result; expected results of a drive by this build");
    }
    curbs.clear();
    for (std::size_t k = Layout::curbs_at; k < header.bytes; k += Layout::curb_bytes)
      curbs.push_back(curb_at(bytes, at + k));
    at += header.bytes;
  }
  return curbs;
}

}  // namespace curbline::tools
