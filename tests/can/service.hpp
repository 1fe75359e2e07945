// The daemon as on a robot, a client that reads its output, and a bus on which a recording is played, with disturbances
// if requested.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "bus.hpp"
#include "program.hpp"

namespace curbline::tools::testing {

/// A running curblined, from start to end. Its client has connected before anything else happens.
class Service {
 public:
  explicit Service(const Words& arguments);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Waits until a line that the client has read satisfies `wanted`, for at most 10 s.
  bool gives(const std::function<bool(const nlohmann::json&)>& wanted) const;
  /// Waits until standard error contains the words, for at most 10 s.
  bool says(const std::string& words) const;

  void signal(int number) const;
  /// Waits for the end. Standard output is the last status line.
  Outcome end();

  std::vector<nlohmann::json> lines() const;  ///< read by the client so far
  std::string socket() const { return directory_.path("curbs"); }
  std::string said() const { return read_file(directory_.path("err")); }

 private:
  void read_lines();

  TemporaryDirectory directory_;
  int process_ = -1, client_ = -1;
  mutable std::mutex mutex_;
  std::vector<nlohmann::json> lines_;
  std::thread reader_;
};

/// Counts how often a text contains some words.
int times_said(const std::string& text, const std::string& words);

/// All distinct curbs in the lines, in the order of their first appearance.
std::vector<nlohmann::json> distinct_curbs(const std::vector<nlohmann::json>& lines);
/// The same for the output of `replay --curbs -` from these logs.
std::vector<nlohmann::json> replayed_curbs(const Words& replay);

/// CHECKs that both have the same curbs, to the last digit.
void check_same(const std::vector<nlohmann::json>& curbs, const std::vector<nlohmann::json>& wanted);

/// The last set of curbs.
nlohmann::json last_curbs(const std::vector<nlohmann::json>& lines);
/// CHECKs that two sets of curbs agree: the same kinds, positions to 5 cm, heights to 5 mm.
void check_alike(const nlohmann::json& curbs, const nlohmann::json& wanted);

/// Plays the frames of a log on vcan0 with their own timing, starting now. `send` transmits a frame, or disturbs it;
/// its last argument is the time since the first frame.
using Send = std::function<void(socketcan::SocketCan& bus, const can::Frame& frame, double since_s)>;
void play(const std::string& log, const Send& send);

}  // namespace curbline::tools::testing
