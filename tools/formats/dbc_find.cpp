#include <algorithm>

#include "formats/bad_input.hpp"
#include "formats/dbc.hpp"

namespace curbline::tools {
namespace {

/// "a, b, c": the first twenty.
template <typename Named>
std::string names_of(const std::vector<Named>& all) {
  std::string names;
  for (std::size_t i = 0; i < all.size() && i < 20; ++i) names += (names.empty() ? "" : ", ") + all[i].name;
  return all.empty() ? "one, but there is none" : all.size() > 20 ? names + ", ..." : names;
}

template <typename Named>
const Named* find(const std::vector<Named>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// Converts one signal of one message for lib/curbline/can.
struct Search {
  const std::string& path;
  const DbcMessage& message;
  const DbcSignal& signal;

  [[noreturn]] void refuse(const std::string& why) const {
    throw BadInput(path, signal.line, "signal " + signal.name + " " + why);
  }
  const DbcSignal& multiplexor() const;
  std::uint64_t multiplexor_value() const;
  void check_place(const DbcSignal& number) const;
};

const DbcSignal& Search::multiplexor() const {
  const DbcSignal* found = nullptr;
  if (!signal.ranges.empty()) {
    found = find(message.signals, signal.multiplexor);
    if (found == nullptr || found == &signal)
      refuse("has the multiplexor " + signal.multiplexor + "; expected another signal of its message");
  } else {
    for (const DbcSignal& other : message.signals) {
      if (!other.is_multiplexor || &other == &signal) continue;
      if (found != nullptr) refuse("could have several multiplexors; expected SG_MUL_VAL_ to say which");
      found = &other;
    }
    if (found == nullptr) refuse("is multiplexed, and its message has no multiplexor; expected one that is marked M");
  }
  if (found->multiplexed || !found->ranges.empty()) refuse("depends on several multiplexors; expected one at most");
  if (found->type != DbcValueType::whole) refuse("has a multiplexor that is a float; expected a whole number");
  return *found;
}

std::uint64_t Search::multiplexor_value() const {
  if (signal.ranges.empty()) return *signal.multiplexed;
  if (signal.ranges.size() > 1 || signal.ranges[0].first != signal.ranges[0].second) {
    refuse("is there for several values of its multiplexor; expected one");
  }
  return signal.ranges[0].first;
}

void Search::check_place(const DbcSignal& number) const {
  const std::string bits = std::to_string(number.start_bit) + "|" + std::to_string(number.length);
  if (number.length < 1 || number.length > 64) refuse("has the bits " + bits + "; expected a length from 1 to 64");
  const can::Signal place{
      .start_bit = number.start_bit, .length = static_cast<std::uint8_t>(number.length), .order = number.order};
  if (!can::valid(place) || can::bytes_needed(place) > message.length) {
    refuse("has the bits " + bits + "; expected them within the " + std::to_string(message.length) +
           " bytes of its message");
  }
}

}  // namespace

DbcTiltSignal find_signal(const Dbc& dbc, const std::string& path, const std::string& message_name,
                          const std::string& signal_name) {
  const DbcMessage* const message = find(dbc, message_name);
  if (message == nullptr) throw BadInput(path + ": no message " + message_name + "; expected " + names_of(dbc));
  const DbcSignal* const signal = find(message->signals, signal_name);
  if (signal == nullptr) {
    throw BadInput(path, message->line,
                   "no signal " + signal_name + " in " + message_name + "; expected " + names_of(message->signals));
  }
  const Search search{path, *message, *signal};
  search.check_place(*signal);
  const bool is_float = signal->type == DbcValueType::float32;
  if (signal->type == DbcValueType::float64)
    search.refuse("is a float of 64 bits; expected a whole number or a float of 32 bits");
  if (is_float && signal->length != 32)
    search.refuse("is a float of " + std::to_string(signal->length) + " bits; expected 32");
  if (signal->scale == 0) search.refuse("has the factor 0; expected another number");
  can::Signal out{.id = message->id,
                  .extended = message->extended,
                  .start_bit = signal->start_bit,
                  .length = static_cast<std::uint8_t>(signal->length),
                  .order = signal->order,
                  .is_signed = signal->is_signed || is_float,
                  .is_float = is_float,
                  .scale = signal->scale,
                  .offset = signal->offset};
  if (signal->multiplexed || !signal->ranges.empty()) {
    const DbcSignal& selector = search.multiplexor();
    search.check_place(selector);
    out.multiplexor = can::Multiplexor{selector.start_bit, static_cast<std::uint8_t>(selector.length), selector.order,
                                       search.multiplexor_value()};
    if (!can::valid(out)) search.refuse("has a value that its multiplexor never has; expected one of its bits");
  }
  const auto stated = [&](const DbcAttribute& attribute) {
    const auto found = message->attributes.find(attribute.name);
    return found == message->attributes.end() ? std::nullopt : std::optional(found->second);
  };
  out.id_mask = stated(id_mask_attribute).value_or(out.id_mask);
  out.min_bytes = static_cast<std::uint8_t>(stated(min_bytes_attribute).value_or(out.min_bytes));
  out.max_bytes = static_cast<std::uint8_t>(stated(max_bytes_attribute).value_or(out.max_bytes));
  if (!can::valid(out)) {
    search.refuse("has the attribute " + std::string(max_bytes_attribute.name) + ' ' + std::to_string(out.max_bytes) +
                  "; expected " + std::to_string(can::bytes_needed(out)) + " or more, which the signal needs");
  }
  return {out, signal->unit, stated(sync_id_attribute)};
}

}  // namespace curbline::tools
