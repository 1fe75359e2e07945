// DBC, Vector's text format for the contents of the frames of a CAN bus: a strict reader of messages and signals, and a
// writer for our own. Debian has no C++ library for it.
//
// Read: BO_ messages, SG_ signals, simple multiplexing (M, m3), SIG_VALTYPE_ floats, SG_MUL_VAL_, extended ids (bit
// 31), the attributes of dbc_attributes. Everything else in the format (comments, other attributes, value tables,
// nodes, environment) is skipped; an unknown statement is an error. Files of at most 16 MiB.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "curbline/can/signal.hpp"

namespace curbline::tools {

enum class DbcValueType : std::uint8_t { whole, float32, float64 };

struct DbcSignal {
  std::string name;
  std::uint16_t start_bit = 0;
  std::uint16_t length = 1;
  can::ByteOrder order = can::ByteOrder::little;
  bool is_signed = false;
  DbcValueType type = DbcValueType::whole;
  double scale = 1, offset = 0;
  double minimum = 0, maximum = 0;  ///< both 0: not specified
  std::string unit;
  bool is_multiplexor = false;               ///< M
  std::optional<std::uint64_t> multiplexed;  ///< m3: present while the multiplexor is 3
  /// SG_MUL_VAL_: the multiplexor's name and the ranges of its value; empty if there is none.
  std::string multiplexor;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
  std::string comment;  ///< only for the writer
  long line = 0;        ///< where it was read
};

/// An attribute of messages for what DBC has no words for: a whole number.
struct DbcAttribute {
  const char* name;
  std::uint32_t lowest, highest, otherwise;  ///< otherwise: the default that a file states
};
inline constexpr DbcAttribute id_mask_attribute{"CurblineIdMask", 0, can::highest_id(true), can::highest_id(true)};
inline constexpr DbcAttribute min_bytes_attribute{"CurblineMinBytes", 0, 64, 0};
inline constexpr DbcAttribute max_bytes_attribute{"CurblineMaxBytes", 1, 64, 64};
inline constexpr DbcAttribute sync_id_attribute{"CurblineSyncId", 0, can::highest_id(false), 0};
inline constexpr std::array dbc_attributes{id_mask_attribute, min_bytes_attribute, max_bytes_attribute,
                                           sync_id_attribute};

struct DbcMessage {
  static constexpr std::uint32_t extended_bit = 0x80000000;

  std::string name;
  std::uint32_t id = 0;
  bool extended = false;
  int length = 8;                                   ///< bytes
  std::string comment;                              ///< only for the writer
  std::map<std::string, std::uint32_t> attributes;  ///< those stated, by name
  std::vector<DbcSignal> signals;
  long line = 0;

  std::uint32_t file_id() const { return extended ? id | extended_bit : id; }  ///< as in a file
};

using Dbc = std::vector<DbcMessage>;

/// Throws BadInput, with the line and what was expected, if the file is not DBC, or if a message or a signal of a
/// message occurs twice.
Dbc read_dbc(const std::string& path);

/// A signal as lib/curbline/can decodes it, the unit of its values, and the SYNC frame on which it is sampled, if one
/// is stated.
struct DbcTiltSignal {
  can::Signal signal;
  std::string unit;
  std::optional<std::uint16_t> sync_id{};
};

/// Throws BadInput if there is no such message or signal (listing those that there are), or if the signal cannot be
/// decoded: a float of 64 bits, one outside its message, one that depends on several multiplexors or values.
DbcTiltSignal find_signal(const Dbc& dbc, const std::string& path, const std::string& message,
                          const std::string& signal);

/// Names must be valid in the format (letters, digits, underscores).
void write_dbc(std::ostream& out, const Dbc& dbc);

}  // namespace curbline::tools
