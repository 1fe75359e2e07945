// A live scanner by its name in --scans, scip2:HOST[:PORT], cola:HOST[:PORT] or lms200:DEVICE: its protocol and its
// byte stream. replay and the daemon make a LiveScanner from it.
#pragma once

#include <memory>
#include <string>

#include "byte_stream/byte_stream.hpp"
#include "curbline/settings.hpp"
#include "scanner/session.hpp"

namespace curbline::tools {

struct ScannerLink {
  std::shared_ptr<scanner::Session> session;
  port::ByteStream stream;
  port::Milliseconds silence;  ///< without a line: the scanner is taken to be lost
  bool has_stamps;             ///< its lines have the scanner's own time
};

/// True for the names above; anything else is a log.
bool is_scanner(const std::string& scans);

/// Not connected yet. Throws BadInput if the name is invalid or its host is unknown.
ScannerLink scanner_link(const std::string& scans, const LaserSettings& laser);

}  // namespace curbline::tools
