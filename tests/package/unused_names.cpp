#include "tests/package/unused_names.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <tuple>

#include "tests/package/declarations.h"

namespace spinaltap::test {
namespace {

struct Place {
  const Source* source;
  Declaration declaration;
};

std::string whole_name(const Declaration& one) { return one.owner.empty() ? one.name : one.owner + "::" + one.name; }

/// Names that are reached from what runs, and from there on.
class Reached {
 public:
  Reached(std::vector<Place>& places, std::span<const std::string> kept) : kept_(kept.begin(), kept.end()) {
    std::set<std::pair<std::string, std::string>> overriding;
    for (const Place& place : places) {
      const Declaration& one = place.declaration;
      if (one.is_class) classes_.insert(one.name);
      if (one.is_override) overriding.emplace(one.owner, one.name);
      if (one.is_root) roots_.insert(one.name);
    }
    for (Place& place : places) {
      Declaration& one = place.declaration;
      if (!classes_.contains(one.owner)) one.owner.clear();  // it is a namespace
      if (overriding.contains({one.owner, one.name})) {      // its class's base calls it
        one.name = one.owner;
        one.owner.clear();
      }
      of_name_[one.name].push_back(&one);
      if (!one.owner.empty()) members_[one.owner].push_back(&one);
    }
  }

  /// What runs names a word.
  void name(const std::string& word) {
    if (words_.insert(word).second) waiting_.push_back(word);
  }
  void use(const Declaration& one) {
    if (!used_.insert(&one).second) return;
    for (const std::string& word : one.words) name(word);
  }
  /// What is reached from the words that were named.
  void follow() {
    while (!waiting_.empty()) {
      const std::string word = waiting_.back();
      waiting_.pop_back();
      for (const auto* all : {&of_name_[word], &members_[word]}) {
        for (const Declaration* one : *all) {
          if (has(*one)) use(*one);
        }
      }
    }
  }

  bool has(const Declaration& one) const {
    return one.name.empty() || kept_.contains(whole_name(one)) || (one.owner.empty() && roots_.contains(one.name)) ||
           (words_.contains(one.name) && (one.owner.empty() || words_.contains(one.owner)));
  }

 private:
  std::map<std::string, std::vector<const Declaration*>> of_name_, members_;
  std::set<std::string> kept_, classes_, roots_, words_;
  std::set<const Declaration*> used_;
  std::vector<std::string> waiting_;
};

}  // namespace

std::vector<UnusedName> unused_names(std::span<const Source> sources, std::span<const std::string> kept) {
  std::vector<Place> places;
  for (const Source& source : sources) {
    for (Declaration& one : declarations(source.text)) places.push_back({&source, std::move(one)});
  }
  Reached reached(places, kept);
  // Called by the language.
  for (const char* const name : {"begin", "end", "get", "tuple_size", "what"}) reached.name(name);
  for (const Place& place : places) {
    const Declaration& one = place.declaration;
    if (one.is_root) reached.name(one.name);
    if (reached.has(one)) reached.use(one);
  }
  reached.follow();
  std::vector<UnusedName> unused;
  std::set<std::string> said;
  for (const Place& place : places) {
    const Declaration& one = place.declaration;
    if (reached.has(one)) continue;
    const std::string name = whole_name(one);
    if (said.insert(name).second) unused.push_back({.name = name, .source = place.source->name, .line = one.line});
  }
  return unused;
}

}  // namespace spinaltap::test
