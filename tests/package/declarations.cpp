#include "tests/package/declarations.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <utility>

namespace spinaltap::test {
namespace {

struct Token {
  std::string_view text;  ///< an identifier, one character, "::", "->", or "\"" for a literal
  int line = 0;
};

bool is_word(std::string_view text) {
  return std::isalpha(static_cast<unsigned char>(text.front())) != 0 || text.front() == '_';
}

/// Where the literal or comment that begins at `at` ends, or `at` where none does.
std::size_t past_literal_or_comment(std::string_view text, std::size_t at) {
  const auto past = [&](std::string_view end, std::size_t from) {
    const std::size_t found = text.find(end, from);
    return found == std::string_view::npos ? text.size() : found + end.size();
  };
  const std::string_view rest = text.substr(at);
  if (rest.starts_with("//")) return past("\n", at) - 1;
  if (rest.starts_with("/*")) return past("*/", at + 2);
  if (rest.starts_with("R\"")) {
    const std::size_t open = text.find('(', at);
    return past(")" + std::string(text.substr(at + 2, open - at - 2)) + "\"", open);
  }
  if (rest.front() != '"' && rest.front() != '\'') return at;
  std::size_t end = at + 1;
  while (end < text.size() && text[end] != rest.front()) end += text[end] == '\\' ? 2 : 1;
  return std::min(end + 1, text.size());
}

std::vector<Token> tokens(std::string_view text) {
  std::vector<Token> found;
  int line = 1;
  bool begins_line = true;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    std::size_t end = past_literal_or_comment(text, at);
    if (rest.front() == '\n') {
      begins_line = true;
      end = at + 1;
    } else if (std::isspace(static_cast<unsigned char>(rest.front())) != 0) {
      end = at + 1;
    } else if (begins_line && rest.front() == '#') {  // to the end of the line that does not go on
      do {
        end = std::min(text.find('\n', end + 1), text.size());
      } while (end < text.size() && text[end - 1] == '\\');
    } else if (end != at) {
      if (rest.front() != '/') found.push_back({.text = "\"", .line = line});
    } else if (is_word(rest) || std::isdigit(static_cast<unsigned char>(rest.front())) != 0) {
      const auto goes_on = [&](char letter) {
        return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_' ||
               (letter == '\'' && !is_word(rest));  // 1'000
      };
      while (end < text.size() && goes_on(text[end])) ++end;
      found.push_back({.text = text.substr(at, end - at), .line = line});
    } else {
      end = at + (rest.starts_with("::") || rest.starts_with("->") ? 2 : 1);
      found.push_back({.text = text.substr(at, end - at), .line = line});
    }
    if (rest.front() != '\n') begins_line = begins_line && std::isspace(static_cast<unsigned char>(rest.front())) != 0;
    line += static_cast<int>(std::count(text.begin() + static_cast<std::ptrdiff_t>(at),
                                        text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    at = end;
  }
  return found;
}

constexpr std::size_t kNone = std::string_view::npos;

/// A declaration as it was read: places of tokens.
struct Head {
  std::size_t from = 0;
  std::size_t to = 0;           ///< past it, its ; left out; of a class the { of its body
  std::size_t name = kNone;     ///< the last word of its name
  std::size_t params = kNone;   ///< the ( of a function
  std::size_t keyword = kNone;  ///< class, struct, union, enum
  bool is_class_body = false;
  bool has_value = false;  ///< = or {
  bool is_override = false;
  bool is_special = false;  ///< template <>
};

class Parser {
 public:
  explicit Parser(std::vector<Token> tokens) : tokens_(std::move(tokens)) {}

  std::vector<Declaration> all() {
    while (!is_end()) scope("", false);
    return std::move(found_);
  }

 private:
  bool is_end() const { return at_ >= tokens_.size(); }
  std::string_view text(std::size_t at) const { return at < tokens_.size() ? tokens_[at].text : std::string_view(); }
  std::string_view here() const { return text(at_); }
  bool has_word(std::size_t from, std::size_t to, std::string_view word) const {
    for (std::size_t n = from; n < to; ++n) {
      if (text(n) == word) return true;
    }
    return false;
  }

  /// From an opening bracket to past the one that closes it.
  std::size_t past_brackets(std::size_t at) const {
    std::size_t depth = 0;
    do {
      const std::string_view one = text(at);
      if (one == "(" || one == "{" || one == "[") ++depth;
      if (one == ")" || one == "}" || one == "]") --depth;
      ++at;
    } while (depth > 0 && at < tokens_.size());
    return at;
  }
  /// From the < of a template's parameters or arguments to past the > that ends them.
  std::size_t past_angles(std::size_t at) const {
    std::size_t depth = 0;
    do {
      const std::string_view one = text(at);
      if (one == "(" || one == "{" || one == "[") {
        at = past_brackets(at);
        continue;
      }
      if (one == "<") ++depth;
      if (one == ">") --depth;
      ++at;
    } while (depth > 0 && at < tokens_.size());
    return at;
  }
  /// From the : after a constructor's parameters to its body.
  void pass_member_values() {
    while (!is_end() && here() != ";") {
      const bool is_value = is_word(text(at_ - 1)) || text(at_ - 1) == ">";
      if (here() == "{" && !is_value) return;
      at_ = here() == "(" || here() == "{" ? past_brackets(at_) : at_ + 1;
    }
  }

  /// Declarations to the } of a scope, which is passed. `owner`: the class whose scope it is.
  void scope(const std::string& owner, bool is_root) {
    while (!is_end() && here() != "}") statement(owner, is_root);
    ++at_;
  }
  bool enter_scope(bool is_root);
  void statement(const std::string& owner, bool is_root);
  Head read_head();
  void pass_operator(Head& head);
  void pass_brackets_of(Head& head);

  Declaration& add(std::string name, std::string owner, std::size_t name_at, std::size_t from, std::size_t to);
  void add_class(const Head& head, const std::string& owner, bool is_root);
  void add_named(const Head& head, const std::string& owner, bool is_root);

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  std::vector<Declaration> found_;
};

/// namespace x { and extern "C" {.
bool Parser::enter_scope(bool is_root) {
  std::size_t open = here() == "inline" ? at_ + 1 : at_;
  const bool is_c = text(open) == "extern" && text(open + 1) == "\"";
  if (!is_c && text(open) != "namespace") return false;
  while (open < tokens_.size() && text(open) != "{" && text(open) != ";" && text(open) != "(") ++open;
  if (text(open) != "{") return false;
  at_ = open + 1;
  scope("", is_root || is_c);
  return true;
}

/// operator and its own signs, to its parameters.
void Parser::pass_operator(Head& head) {
  if (head.params == kNone) head.name = at_;
  ++at_;
  while (!is_end() && here() != "(") ++at_;
  if (text(at_ + 1) == ")" && text(at_ + 2) == "(") at_ += 2;
}

void Parser::pass_brackets_of(Head& head) {
  const bool is_open = head.params == kNone && !head.has_value && at_ > head.from;
  if (here() == "[") {  // of an array, or an attribute
    if (is_open && head.name == kNone && is_word(text(at_ - 1))) head.name = at_ - 1;
    at_ = past_brackets(at_);
    return;
  }
  if (is_open) {
    head.params = at_;
    if (head.name == kNone) head.name = at_ - 1;
  }
  at_ = past_brackets(at_);
  if (is_open && here() == ":") pass_member_values();
}

Head Parser::read_head() {
  Head head;
  head.from = at_;
  while (!is_end() && here() != ";" && here() != "}") {
    const bool is_before_name = head.params == kNone && !head.has_value;
    if (here() == "template" || here() == "requires") {
      head.is_special = head.is_special || (text(at_ + 1) == "<" && text(at_ + 2) == ">");
      const std::string_view next = text(at_ + 1);
      at_ = next == "<" ? past_angles(at_ + 1) : next == "(" ? past_brackets(at_ + 1) : at_ + 1;
    } else if (here() == "operator") {
      pass_operator(head);
    } else if (here() == "(" || here() == "[") {
      pass_brackets_of(head);
    } else if (here() == "<" && is_before_name) {
      at_ = past_angles(at_);
    } else if (here() == "{") {
      head.is_class_body = head.keyword != kNone && is_before_name;
      if (head.is_class_body) break;
      const bool is_body = head.params != kNone && !head.has_value;
      if (head.name == kNone && at_ > head.from) head.name = at_ - 1;
      head.has_value = head.has_value || !is_body;
      at_ = past_brackets(at_);
      if (is_body) break;
    } else {
      const bool is_class = here() == "class" || here() == "struct" || here() == "union" || here() == "enum";
      if (is_class && is_before_name && head.keyword == kNone) head.keyword = at_;
      if (here() == "=" && head.params == kNone) {
        if (head.name == kNone) head.name = at_ - 1;
        head.has_value = true;
      }
      head.is_override = head.is_override || here() == "override";
      ++at_;
    }
  }
  head.to = at_;
  return head;
}

Declaration& Parser::add(std::string name, std::string owner, std::size_t name_at, std::size_t from, std::size_t to) {
  Declaration one{.name = std::move(name), .owner = std::move(owner)};
  one.line = tokens_[std::min(name_at, tokens_.size() - 1)].line;
  std::size_t own = name_at;  // with its qualifiers
  while (own >= from + 2 && text(own - 1) == "::") own -= 2;
  for (std::size_t n = from; n < to; ++n) {
    const bool is_own = !one.name.empty() && n >= own && n <= name_at;
    if (is_word(text(n)) && !is_own) one.words.emplace_back(text(n));
  }
  found_.push_back(std::move(one));
  return found_.back();
}

void Parser::add_class(const Head& head, const std::string& owner, bool is_root) {
  const std::size_t open = head.to, end = past_brackets(open);
  std::size_t name_at = head.keyword + 1;
  const bool is_enum = text(head.keyword) == "enum", is_enum_class = is_enum && text(name_at) == "class";
  if (is_enum_class) ++name_at;
  while (text(name_at) == "[") name_at = past_brackets(name_at);  // attributes
  while (text(name_at + 1) == "::" && is_word(text(name_at + 2))) name_at += 2;
  // A specialisation is used where its template is; a class without a name is its owner's, and so is an enum, whose
  // enumerators are named without it.
  const bool is_special = text(name_at + 1) == "<";
  const bool is_owners = !is_word(text(name_at)) || (is_enum && !is_enum_class);
  const std::string name = is_owners ? owner : is_special ? "" : std::string(text(name_at));
  Declaration& one = add(name, is_owners ? "" : owner, name_at, head.from, is_enum ? end : open);
  one.is_class = !is_owners;
  one.is_root = is_root;
  if (is_enum) {
    at_ = end;
  } else {
    at_ = open + 1;
    scope(name, is_root);
  }
  const std::size_t after = at_;  // what is declared of it at once, as in struct { } x;
  while (!is_end() && here() != ";") at_ = here() == "{" ? past_brackets(at_) : at_ + 1;
  if (at_ > after) add(owner, "", after, after, at_).words.push_back(name);
  ++at_;
}

void Parser::add_named(const Head& head, const std::string& owner, bool is_root) {
  const std::size_t from = head.from, to = head.to;
  const bool is_using = text(from) == "using";
  if (is_using && text(from + 1) == "namespace") return;
  if (head.keyword != kNone && head.params == kNone && !head.has_value && to - head.keyword <= 3) return;  // class X;
  if (is_using || text(from) == "typedef") {
    const std::size_t named = is_using && text(from + 2) == "=" ? from + 1 : to - 1;
    add(std::string(text(named)), owner, named, from, to).is_root = is_root;
    return;
  }
  const std::size_t name_at = head.name != kNone && is_word(text(head.name)) ? head.name : to - 1;
  const std::string name(text(name_at));
  std::string of = owner;
  if (owner.empty() && name_at >= from + 2 && text(name_at - 1) == "::") {
    std::size_t qualifier = name_at - 2;
    if (text(qualifier) == ">") {
      while (qualifier > from && text(qualifier) != "<") --qualifier;
      --qualifier;
    }
    of = text(qualifier);
  }
  const bool is_field = head.params == kNone && !of.empty() && !has_word(from, name_at, "static");
  const bool is_end_of_life = name == of || (name_at > from && text(name_at - 1) == "~");
  const bool is_macro = head.params != kNone && name_at == from && !is_end_of_life;
  if (is_field || is_end_of_life || name == "operator" || text(from) == "friend") {
    add(of, "", name_at, from, to).is_root = is_root;
  } else if (is_macro || head.is_special) {
    add("", "", name_at, from, to);
  } else {
    Declaration& one = add(name, of, name_at, from, to);
    one.is_root = is_root || name == "main" || has_word(from, name_at, "maybe_unused");
    one.is_override = head.is_override;
  }
}

void Parser::statement(const std::string& owner, bool is_root) {
  constexpr std::array<std::string_view, 8> kAlone{"public",  "private",   "protected", "slots",
                                                   "Q_SLOTS", "Q_SIGNALS", "Q_OBJECT",  ":"};
  if (here() == ";" || std::find(kAlone.begin(), kAlone.end(), here()) != kAlone.end()) {
    ++at_;
    return;
  }
  if (enter_scope(is_root)) return;
  const bool is_c = here() == "extern" && text(at_ + 1) == "\"";
  const Head head = read_head();
  if (head.is_class_body) {
    add_class(head, owner, is_root);
    return;
  }
  if (here() == ";") ++at_;
  if (head.to > head.from) add_named(head, owner, is_root || is_c);
}

}  // namespace

std::vector<Declaration> declarations(std::string_view text) { return Parser(tokens(text)).all(); }

}  // namespace spinaltap::test
