#pragma once

#include <cctype>
#include <string>
#include <vector>

/// A check of XML that needs no library: enough for pages and pictures that we write.
namespace burnish::test {

/// Reads names, attributes, entities and nesting; "" or what is wrong and where.
class XmlChecker {
 public:
  explicit XmlChecker(const std::string& text) : text_(text) {}

  std::string run() {
    if (starts("<!DOCTYPE html>")) at_ += 15;
    while (error_.empty() && at_ < text_.size()) {
      if (text_[at_] == '<')
        read_tag();
      else if (text_[at_] == '&')
        read_entity();
      else if (static_cast<unsigned char>(text_[at_]) < 0x20 && !std::isspace(text_[at_]))
        fail("a control character");
      else
        ++at_;
      if (error_.empty() && open_.empty() && roots_ > 1) fail("a second root");
    }
    if (error_.empty() && !open_.empty()) fail("<" + open_.back() + "> that is not closed");
    if (error_.empty() && roots_ != 1) fail("no root");
    return error_;
  }

 private:
  bool starts(const std::string& prefix) const {
    return text_.compare(at_, prefix.size(), prefix) == 0;
  }
  void fail(const std::string& what) {
    if (error_.empty()) error_ = what + " at byte " + std::to_string(at_);
  }
  std::string read_name() {
    std::string name;
    while (at_ < text_.size() &&
           (std::isalnum(text_[at_]) || text_[at_] == '-' || text_[at_] == ':'))
      name += text_[at_++];
    if (name.empty()) fail("no name");
    return name;
  }
  void skip_blanks() {
    while (at_ < text_.size() && std::isspace(text_[at_])) ++at_;
  }
  void read_entity() {
    for (const char* known : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"})
      if (starts(known)) {
        at_ += std::string(known).size();
        return;
      }
    fail("an ampersand that is no entity");
  }
  void read_attribute() {
    read_name();
    if (!starts("=\"")) return fail("an attribute without a quoted value");
    at_ += 2;
    while (error_.empty() && at_ < text_.size() && text_[at_] != '"') {
      if (text_[at_] == '<') return fail("< in a value");
      if (text_[at_] == '&')
        read_entity();
      else
        ++at_;
    }
    ++at_;
  }
  void read_tag() {
    ++at_;
    const bool closes = at_ < text_.size() && text_[at_] == '/';
    if (closes) ++at_;
    const std::string name = read_name();
    if (closes) {
      if (open_.empty() || open_.back() != name) return fail("</" + name + "> that closes nothing");
      open_.pop_back();
      if (!starts(">")) return fail("no >");
      ++at_;
      return;
    }
    if (open_.empty()) ++roots_;
    for (skip_blanks(); error_.empty(); skip_blanks()) {
      if (starts("/>")) {
        at_ += 2;
        return;
      }
      if (starts(">")) {
        ++at_;
        open_.push_back(name);
        return;
      }
      read_attribute();
    }
  }

  const std::string& text_;
  std::size_t at_ = 0;
  int roots_ = 0;
  std::vector<std::string> open_;
  std::string error_;
};

inline std::string xml_fault(const std::string& text) { return XmlChecker(text).run(); }

}  // namespace burnish::test
