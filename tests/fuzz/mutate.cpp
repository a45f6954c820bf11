#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

namespace spinaltap::test {
namespace {

constexpr std::array<std::uint32_t, 12> kOddNumbers{0,      1,      2,          0x7f,       0xff,       0x7fff,
                                                    0x8000, 0xffff, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff};
constexpr std::array<std::string_view, 10> kOddTexts{
    "nan", "inf", "-1", "0\\0", "1e308", "1e-300", "99999999999", "-0", "1\\0\\0\\1\\0\\0", ""};

struct Mutator {
  std::string& bytes;
  const std::string& other;
  std::mt19937_64& random;

  std::size_t below(std::size_t count) { return count > 0 ? random() % count : 0; }
  std::size_t somewhere() {
    if (below(3) == 0) return below(std::min<std::size_t>(bytes.size(), 400));  // heads matter most
    return below(bytes.size());
  }

  void flip_bit() { bytes[somewhere()] ^= static_cast<char>(1 << below(8)); }
  void set_byte() { bytes[somewhere()] = static_cast<char>(below(256)); }
  void set_number() {
    const std::uint32_t number = below(4) == 0 ? static_cast<std::uint32_t>(random()) : kOddNumbers[below(12)];
    const std::size_t size = below(2) == 0 ? 2 : 4;
    const bool big_endian = below(2) == 0;
    const std::size_t at = somewhere();
    for (std::size_t n = 0; n < size && at + n < bytes.size(); ++n) {
      bytes[at + n] = static_cast<char>(number >> (8 * (big_endian ? size - 1 - n : n)) & 0xff);
    }
  }
  /// Over digits, where a decimal string stands.
  void set_text() {
    const std::size_t digit = bytes.find_first_of("0123456789", somewhere());
    if (digit == std::string::npos) return;
    const std::string_view text = kOddTexts[below(kOddTexts.size())];
    for (std::size_t n = 0; n < text.size() && digit + n < bytes.size(); ++n) bytes[digit + n] = text[n];
  }
  void cut() { bytes.resize(somewhere()); }
  void remove() {
    const std::size_t at = somewhere();
    bytes.erase(at, 1 + below(16));
  }
  void repeat() {
    const std::size_t at = somewhere();
    const std::string piece = bytes.substr(at, 1 + below(64));
    bytes.insert(at, piece);
  }
  void splice() {
    if (other.empty()) return;
    const std::string piece = other.substr(below(other.size()), 1 + below(200));
    const std::size_t at = somewhere();
    bytes.replace(at, below(2) == 0 ? 0 : piece.size(), piece);
  }
};

using OrderedJson = nlohmann::ordered_json;

/// Stands for a text that a JSON value cannot hold, until all is text.
constexpr std::string_view kRawMark = "@raw:";
constexpr std::array<std::string_view, 22> kOddValues{"0",           "-1",
                                                      "1",           "0.5",
                                                      "1e-9",        "5e-324",
                                                      "1e308",       "-1e308",
                                                      "1e999",       "-0.0",
                                                      "2147483648",  "1e18",
                                                      "1e19",        "null",
                                                      "false",       "4294967296",
                                                      "\"\"",        "\"nan\"",
                                                      "\"\\u0000\"", "[]",
                                                      "{}",          "18446744073709551616"};

void gather(OrderedJson& node, std::vector<OrderedJson*>& nodes) {
  nodes.push_back(&node);
  if (node.is_structured()) {
    for (OrderedJson& child : node) gather(child, nodes);
  }
}

class JsonMutator {
 public:
  JsonMutator(OrderedJson& root, const OrderedJson& other, std::mt19937_64& random)
      : root_(root), other_(other), random_(random) {}

  void change() {
    std::vector<OrderedJson*> nodes;
    gather(root_, nodes);
    OrderedJson& node = *nodes[below(nodes.size())];
    switch (below(10)) {
      case 0:
        remove_from(node);
        break;
      case 1:
        rename_in(node);
        break;
      case 2:
        repeat_in(node);
        break;
      case 3:
        swap_apart(node, *nodes[below(nodes.size())]);
        break;
      case 4:
        take_from_other(node);
        break;
      case 5:
        grow(node);
        break;
      default:
        node = std::string(kRawMark) + std::string(kOddValues[below(kOddValues.size())]);
    }
  }

 private:
  std::size_t below(std::size_t count) { return count > 0 ? random_() % count : 0; }

  /// Neither may be in the other, which would hold itself then.
  static void swap_apart(OrderedJson& a, OrderedJson& b) {
    for (const auto& [outer, inner] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
      std::vector<OrderedJson*> within;
      gather(*outer, within);
      if (std::find(within.begin(), within.end(), inner) != within.end()) return;
    }
    std::swap(a, b);
  }
  void remove_from(OrderedJson& node) {
    if (!node.is_structured() || node.empty()) return;
    node.erase(std::next(node.begin(), static_cast<std::ptrdiff_t>(below(node.size()))));
  }
  void rename_in(OrderedJson& node) {
    if (!node.is_object() || node.empty()) return;
    const auto item = std::next(node.begin(), static_cast<std::ptrdiff_t>(below(node.size())));
    const OrderedJson value = item.value();
    const std::string key = item.key();
    node.erase(key);
    node[below(2) == 0 ? key + "_" : std::string()] = value;
  }
  void repeat_in(OrderedJson& node) {
    if (!node.is_array() || node.empty()) return;
    const OrderedJson one = node[below(node.size())];
    constexpr std::array<std::size_t, 4> kTimes{1, 2, 100, 3000};
    constexpr std::size_t kMaxBytes = std::size_t{16} << 20;  // the fuzzer itself has little memory
    const std::size_t most = kMaxBytes / one.dump().size();
    for (std::size_t left = std::min(kTimes[below(kTimes.size())], most); left > 0; --left) node.push_back(one);
  }
  void take_from_other(OrderedJson& node) {
    OrderedJson copy = other_;
    std::vector<OrderedJson*> nodes;
    gather(copy, nodes);
    const OrderedJson taken = *nodes[below(nodes.size())];
    node = taken;
  }
  /// What is long, or deep.
  void grow(OrderedJson& node) {
    constexpr std::array<std::size_t, 4> kSizes{3, 200, 5000, 100'000};
    const std::size_t size = kSizes[below(kSizes.size())];
    const bool is_deep = below(2) == 0;
    node = std::string(kRawMark) +
           (is_deep ? std::string(size, '[') + std::string(size, ']') : '"' + std::string(size, 'x') + '"');
  }

  OrderedJson& root_;
  const OrderedJson& other_;
  std::mt19937_64& random_;
};

/// The text with what marked strings hold in their place.
std::string without_marks(std::string text) {
  const std::string begin = '"' + std::string(kRawMark);
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    std::size_t end = at + begin.size();
    std::string raw;
    for (; end < text.size() && text[end] != '"'; ++end) {
      if (text[end] == '\\') ++end;  // a quote or a backslash within
      raw += text[end];
    }
    text.replace(at, end + 1 - at, raw);
    at += raw.size();
  }
  return text;
}

}  // namespace

std::string mutated_json(const std::string& text, const std::string& other, std::mt19937_64& random) {
  OrderedJson json = OrderedJson::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return mutated(text, other, random);
  OrderedJson stranger = OrderedJson::parse(other, nullptr, false);
  if (stranger.is_discarded()) stranger = json;
  JsonMutator mutator(json, stranger, random);
  for (std::size_t left = 1 + random() % 3; left > 0; --left) mutator.change();
  return without_marks(json.dump(random() % 2 == 0 ? -1 : 2));
}

std::string mutated(std::string bytes, const std::string& other, std::mt19937_64& random) {
  Mutator mutator{bytes, other, random};
  for (std::size_t left = 1 + mutator.below(4); left > 0 && !bytes.empty(); --left) {
    switch (mutator.below(10)) {
      case 0:
      case 1:
        mutator.flip_bit();
        break;
      case 2:
        mutator.set_byte();
        break;
      case 3:
      case 4:
        mutator.set_number();
        break;
      case 5:
        mutator.set_text();
        break;
      case 6:
        mutator.cut();
        break;
      case 7:
        mutator.remove();
        break;
      case 8:
        mutator.repeat();
        break;
      default:
        mutator.splice();
    }
  }
  return bytes;
}

}  // namespace spinaltap::test
