// The daemon as a robot runs it, a client that reads what it gives out, and a bus on which a recording is played with
// whatever may befall it.
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

/// curblined, from its start to its end. Its client has connected before anything else happens.
class Service {
 public:
  explicit Service(const Words& arguments);
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Waits until a line that a client has read satisfies `wanted`, 10 s at most.
  bool gives(const std::function<bool(const nlohmann::json&)>& wanted) const;
  /// Waits until standard error holds the words, 10 s at most.
  bool says(const std::string& words) const;

  void signal(int number) const;
  /// Waits for the end. Standard output is the last status line.
  Outcome end();

  std::vector<nlohmann::json> lines() const;  ///< that the client has read
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

/// How often a text holds some words.
int times_said(const std::string& text, const std::string& words);

/// All curbs that lines hold, each once, in the order of their first appearance.
std::vector<nlohmann::json> distinct_curbs(const std::vector<nlohmann::json>& lines);
/// The same of what `replay --curbs -` streams for these logs.
std::vector<nlohmann::json> replayed_curbs(const Words& replay);

/// CHECKs that both have the same curbs, to the last digit.
void check_same(const std::vector<nlohmann::json>& curbs, const std::vector<nlohmann::json>& wanted);

/// The last set of curbs.
nlohmann::json last_curbs(const std::vector<nlohmann::json>& lines);
/// CHECKs that they are those of the other set: kinds, places to 5 cm, heights to 5 mm.
void check_alike(const nlohmann::json& curbs, const nlohmann::json& wanted);

/// The frames of a log at their own times on vcan0, from when the first is sent. `send` stands for what the bus makes
/// of a frame, at its time since the first.
using Send = std::function<void(socketcan::SocketCan& bus, const can::Frame& frame, double since_s)>;
void play(const std::string& log, const Send& send);

}  // namespace curbline::tools::testing
