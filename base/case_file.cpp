#include "base/case_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include "base/json.hpp"

namespace calomel {

struct CaseFile::Document {
  toml::table root;
  std::set<std::string> accepted;
};

namespace {

std::string value_text(const toml::node& node) {
  if (node.is_table()) return "";
  std::ostringstream s;
  if (const auto* list = node.as_array()) {
    for (const auto& element : *list) s << (s.tellp() > 0 ? ", " : "[") << value_text(element);
    s << (list->empty() ? "[]" : "]");
  } else if (node.is_floating_point())
    s << number_text(*node.value<double>());
  else
    node.visit([&](const auto& v) { s << v; });
  std::string text = s.str();
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

/// Dotted path of a key or table of this name inside one of the tables at the root, "geometry.length" of "length"; empty where there is none.
std::string path_ending_with(const toml::table& root, const std::string& name) {
  for (const auto& [outer, node] : root)
    if (const auto* table = node.as_table(); table && outer.str() != name && table->contains(name)) return std::string(outer.str()) + '.' + name;
  return "";
}

/// "sensor[1].position" -> the node, or null.
const toml::node* node_at(const toml::table& root, const std::string& path) {
  if (path.empty()) return &root;
  return root.at_path(path).node();
}

/// The node at `path` as JSON. Errors: InputError for what JSON has not: dates, and numbers that are not finite.
Json json_of(const toml::node& node, const std::string& path) {
  if (const auto* table = node.as_table()) {
    Json out = Json::object();
    for (const auto& [key, value] : *table) out[std::string(key.str())] = json_of(value, path + '.' + std::string(key.str()));
    return out;
  }
  if (const auto* list = node.as_array()) {
    Json out = Json::array();
    for (std::size_t i = 0; i < list->size(); ++i) out.push_back(json_of((*list)[i], fmt::format("{}[{}]", path, i)));
    return out;
  }
  if (const auto text = node.value_exact<std::string>()) return *text;
  if (const auto truth = node.value_exact<bool>()) return *truth;
  if (const auto whole = node.value_exact<std::int64_t>()) return *whole;
  if (const auto real = node.value_exact<double>(); real && std::isfinite(*real)) return *real;
  throw InputError({.problem = "cannot be handed on as JSON, which has neither dates nor numbers that are not finite", .key = path, .value = value_text(node)});
}

InputError from_parse_error(const toml::parse_error& e, const std::string& name, const std::string& text) {
  const auto& at = e.source().begin;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t i = 0; i < at.line && std::getline(lines, line);) ++i;
  static const std::regex decimal_comma(R"(=\s*-?\d+,\d)");
  return InputError(
      {.problem = fmt::format("not valid TOML: {}", e.description()),
       .suggestion = std::regex_search(line, decimal_comma) ? "write numbers with a decimal point, not a comma" : "see https://toml.io for the format",
       .file = name,
       .line = int(at.line),
       .column = int(at.column)});
}

void merge(toml::table& into, toml::table&& from) {
  for (auto&& [key, node] : from) {
    auto* inner = into.get_as<toml::table>(key.str());
    if (inner && node.is_table())
      merge(*inner, std::move(*node.as_table()));
    else
      into.insert_or_assign(key.str(), std::move(node));
  }
}

/// The table of this name among those of `key`. Errors: InputError naming the known ones.
toml::table* named_element(toml::array& list, const std::string& name, const std::string& key, const std::string& origin) {
  std::vector<std::string> known;
  for (auto& node : list) {
    auto& element = *node.as_table();
    known.push_back(element["name"].value_or(std::string()));
    if (known.back() == name) return &element;
  }
  throw InputError({.problem = "no element has this name",
                    .key = key,
                    .value = '"' + name + '"',
                    .range = join(known),
                    .suggestion = name_suggestion(name, known),
                    .file = origin});
}

void apply_override(toml::table& root, const std::string& text) {
  const std::string origin = "--set " + text;
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(
        {.problem = "an override needs the form table.key=value", .value = '"' + origin + '"', .suggestion = "e.g. --set geometry.element_size=0.002"});
  const std::string path = text.substr(0, equals), value = text.substr(equals + 1);
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value, origin);
  } catch (const toml::parse_error&) {  // a bare word is a string
    try {
      parsed = toml::parse("value = \"" + value + "\"", origin);
    } catch (const toml::parse_error& e) {
      throw from_parse_error(e, origin, "value = " + value);
    }
  }
  toml::node& node = *parsed.get("value");
  if (const auto bracket = path.find('['); bracket != std::string::npos) {  // an element of an array of tables: sensor[1].gain
    const auto close = path.find(']', bracket), dot = path.rfind('.');
    auto* owner = close == std::string::npos || dot == std::string::npos || dot < close ? nullptr : root.at_path(path.substr(0, dot)).as_table();
    if (!owner) throw InputError({.problem = "no such element", .key = path, .suggestion = "elements count from 0", .file = origin});
    owner->insert_or_assign(path.substr(dot + 1), std::move(node));
    return;
  }
  toml::table* at = &root;
  std::size_t begin = 0;
  for (auto dot = path.find('.'); dot != std::string::npos; begin = dot + 1, dot = path.find('.', begin)) {
    const std::string key = path.substr(begin, dot - begin);
    if (!at->contains(key)) at->insert(key, toml::parse("", origin));
    if (auto* list = at->get_as<toml::array>(key); list && list->is_array_of_tables()) {  // an element by its name: sensor.B.gain
      const auto after = path.find('.', dot + 1);
      at = named_element(*list, path.substr(dot + 1, after == std::string::npos ? after : after - dot - 1), key, origin);
      if (after == std::string::npos)
        throw InputError({.problem = "an override sets one key of it", .key = path, .suggestion = "e.g. --set " + path + ".KEY=VALUE", .file = origin});
      dot = after;
      continue;
    }
    at = at->get_as<toml::table>(key);
    if (!at) throw InputError({.problem = fmt::format("\"{}\" is a value, not a table", key), .key = path, .file = origin});
  }
  const std::string last = path.substr(begin);
  if (auto* table = node.as_table(); table && at->get_as<toml::table>(last))
    merge(*at->get_as<toml::table>(last), std::move(*table));
  else
    at->insert_or_assign(last, std::move(node));
}

}  // namespace

CaseFile::~CaseFile() = default;
CaseFile::CaseFile(CaseFile&&) noexcept = default;
CaseFile& CaseFile::operator=(CaseFile&&) noexcept = default;

CaseFile::CaseFile(std::filesystem::path path, std::span<const std::string> overrides) {
  std::ifstream in(path);
  if (!in || std::filesystem::is_directory(path))
    throw InputError({.problem = "cannot be opened", .suggestion = "check the name; a case file ends in .toml (see examples/)", .file = path.string()});
  std::stringstream text;
  text << in.rdbuf();
  *this = from_text(text.str(), path.string());
  for (const auto& o : overrides) apply_override(document_->root, o);
}

CaseFile CaseFile::from_text(const std::string& text, const std::string& name) {
  CaseFile file;
  file.path_ = name;
  file.document_ = std::make_unique<Document>();
  try {
    file.document_->root = toml::parse(text, name);
  } catch (const toml::parse_error& e) {
    throw from_parse_error(e, name, text);
  }
  return file;
}

std::filesystem::path CaseFile::resolve(const std::string& relative) const {
  const std::filesystem::path p(relative);
  return p.is_absolute() ? p : path_.parent_path() / p;
}

bool CaseFile::has(const std::string& path) const { return node_at(document_->root, path) != nullptr; }

std::vector<std::string> CaseFile::names(const std::string& path) const {
  const auto* node = node_at(document_->root, path);
  const auto* table = node ? node->as_table() : nullptr;
  if (!table) return {};
  // File order; what a --set added (its source is not the file) comes last, in alphabetical order.
  std::vector<std::tuple<bool, std::uint32_t, std::uint32_t, std::string>> order;
  for (const auto& [key, value] : *table) {
    const auto& at = value.source().begin.line ? value.source() : key.source();
    order.emplace_back(at.path && *at.path != path_.string(), at.begin.line, at.begin.column, std::string(key.str()));
  }
  std::sort(order.begin(), order.end());
  std::vector<std::string> out;
  for (auto& o : order) out.push_back(std::get<3>(o));
  return out;
}

std::size_t CaseFile::count(const std::string& path) const {
  const auto* node = node_at(document_->root, path);
  return node && node->is_array() ? node->as_array()->size() : 0;
}

std::optional<std::string> CaseFile::text(const std::string& path) const {
  const auto* node = node_at(document_->root, path);
  return node ? node->value_exact<std::string>() : std::nullopt;
}

namespace {

/// Of a node that is a number: toml++ gives no double of an integer that a double does not hold.
double number_of(const toml::node& node) {
  const auto exact = node.value<double>();
  return exact ? *exact : double(*node.value<std::int64_t>());
}

}  // namespace

std::optional<double> CaseFile::number(const std::string& path) const {
  const auto* node = node_at(document_->root, path);
  return node && node->is_number() ? std::optional(number_of(*node)) : std::nullopt;
}

Json CaseFile::json(const std::string& path) const {
  const auto* node = node_at(document_->root, path);
  if (!node) return Json::object();
  return locating([&] { return json_of(*node, path); });
}

void CaseFile::accept(const std::string& path) { document_->accepted.insert(path); }

void CaseFile::expect_all_read(std::span<const std::string> known_tables) const {
  for (const auto& name : names("")) {
    if (document_->accepted.contains(name) || std::find(known_tables.begin(), known_tables.end(), name) != known_tables.end()) continue;
    const std::string inside = path_ending_with(document_->root, name), near = name_suggestion(name, known_tables);
    throw located(InputError({.problem = "unknown table or key",
                              .key = name,
                              .range = inside.empty() && near.empty() ? join(known_tables) : "",
                              .suggestion = inside.empty() ? near : "did you mean \"" + inside + "\"?"}));
  }
}

InputError CaseFile::located(const InputError& error) const {
  auto parts = error.parts();
  if (!parts.file.empty()) return error;
  parts.file = path_.string();
  // The key itself, or the nearest enclosing table in the file.
  std::string at = parts.key;
  const toml::node* node = nullptr;
  const toml::key* key = nullptr;
  while (!(node = node_at(document_->root, at)) || at.empty()) {
    const auto cut = at.find_last_of(".[");
    if (cut == std::string::npos) break;
    at = at.substr(0, cut);
  }
  if (node && !at.empty()) {
    if (parts.value.empty() && at == parts.key) parts.value = value_text(*node);
    const auto cut = at.rfind('.');
    const auto* owner = node_at(document_->root, cut == std::string::npos ? "" : at.substr(0, cut));
    if (owner && owner->is_table())
      for (const auto& [k, v] : *owner->as_table())
        if (&v == node) key = &k;
    const bool of_override = node->source().path && *node->source().path != path_.string();  // the replaced key still has its place
    const auto& source = !of_override && key && key->source().begin.line ? key->source() : node->source();
    parts.line = int(source.begin.line);
    parts.column = int(source.begin.column);
    if (source.path && *source.path != path_.string()) {
      parts.file = *source.path;
      parts.line = 0;
    }
  }
  return InputError(parts);
}

CaseFile::Reader::Reader(CaseFile& file, std::string path) : file_(file), path_(std::move(path)) {
  const auto* node = node_at(file_.document_->root, path_);
  if (node && !node->is_table())
    throw file_.located(InputError({.problem = "a table is expected here", .key = path_, .suggestion = "write [" + path_ + "] and its keys below"}));
  table_ = node ? node->as_table() : nullptr;
  if (table_) file_.accept(path_.substr(0, path_.find_first_of(".[")));
}
CaseFile::Reader::~Reader() = default;

const toml::node* CaseFile::Reader::find(const char* key, const FieldInfo& info) {
  known_.push_back(key);
  const auto* node = table_ ? table_->get(key) : nullptr;
  if (!node && info.required) {
    std::vector<std::string> there;
    if (table_)
      for (const auto& [k, v] : *table_) there.emplace_back(k.str());
    const auto near = nearest_name(key, there);
    const bool typo = !near.empty() && edit_distance(near, key) <= 2;
    if (typo) throw file_.located(InputError({.problem = "unknown key", .key = path_ + '.' + near, .suggestion = fmt::format("did you mean \"{}\"?", key)}));
    throw file_.located(InputError(
        {.problem = fmt::format("the key \"{}\" is missing and has no default: {}{}", key, info.doc, info.unit.empty() ? "" : " [" + info.unit + "]"),
         .key = path_,
         .range = info.choices.empty() ? "" : join(info.choices),
         .suggestion = fmt::format("add {} = ... under [{}]", key, path_)}));
  }
  return node;
}

void CaseFile::Reader::fail(const toml::node&, const std::string& key, const std::string& expected, const FieldInfo& info) {
  std::string range = !info.choices.empty() ? join(info.choices) : expected.find("number") != std::string::npos ? info.range.text() : "";
  throw file_.located(InputError({.problem = expected + " is expected" + (info.unit.empty() ? "" : " [" + info.unit + "]") + ": " + info.doc,
                                  .key = path_.empty() ? key : path_ + '.' + key,
                                  .range = range}));
}

void CaseFile::Reader::fail_size(const char* key, std::size_t wanted, std::size_t got) {
  throw file_.located(InputError({.problem = fmt::format("{} numbers are expected, {} given", wanted, got), .key = path_ + '.' + key}));
}

double CaseFile::Reader::number(const toml::node& node, const std::string& key, const FieldInfo& info) {
  if (!node.is_number()) fail(node, key, "a number", info);
  const double x = number_of(node);
  if (!std::isfinite(x) || !info.range.contains(x))
    throw file_.located(InputError({.problem = "out of range: " + info.doc + (info.unit.empty() ? "" : " [" + info.unit + "]"),
                                    .key = path_.empty() ? key : path_ + '.' + key,
                                    .value = number_text(x),
                                    .range = info.range.text()}));
  return x;
}

void CaseFile::Reader::operator()(const char* key, bool& value, const FieldInfo& info) {
  if (const auto* n = find(key, info)) {
    if (!n->is_boolean()) fail(*n, key, "true or false", info);
    value = *n->value<bool>();
  }
}
void CaseFile::Reader::operator()(const char* key, int& value, const FieldInfo& info) {
  if (const auto* n = find(key, info)) {
    const double x = number(*n, key, info);
    if (x != std::floor(x) || std::abs(x) > 2e9) fail(*n, key, "a whole number", info);
    value = int(x);
  }
}
void CaseFile::Reader::operator()(const char* key, double& value, const FieldInfo& info) {
  if (const auto* n = find(key, info)) value = number(*n, key, info);
}
void CaseFile::Reader::operator()(const char* key, std::optional<double>& value, const FieldInfo& info) {
  if (const auto* n = find(key, info)) value = number(*n, key, info);
}
void CaseFile::Reader::operator()(const char* key, std::string& value, const FieldInfo& info) {
  const auto* n = find(key, info);
  if (!n) return;
  if (!n->is_string()) fail(*n, key, "a text in quotes", info);
  value = *n->value<std::string>();
  if (!info.choices.empty() && std::find(info.choices.begin(), info.choices.end(), value) == info.choices.end())
    throw file_.located(InputError({.problem = "not a known choice: " + info.doc,
                                    .key = path_.empty() ? key : path_ + '.' + key,
                                    .value = '"' + value + '"',
                                    .range = join(info.choices),
                                    .suggestion = name_suggestion(value, info.choices)}));
}
void CaseFile::Reader::operator()(const char* key, std::vector<double>& value, const FieldInfo& info) {
  const auto* n = find(key, info);
  if (!n) return;
  if (!n->is_array()) fail(*n, key, "a list of numbers", info);
  value.clear();
  for (const auto& element : *n->as_array()) value.push_back(number(element, key, info));
  if (value.size() < info.least_size) fail_size(key, info.least_size, value.size());
}
void CaseFile::Reader::operator()(const char* key, std::vector<int>& value, const FieldInfo& info) {
  const auto* n = find(key, info);
  if (!n) return;
  std::vector<double> list;
  (*this)(key, list, info);
  value.clear();
  for (const double x : list) {
    if (x != std::floor(x) || std::abs(x) > 2e9) fail(*n, key, "a list of whole numbers", info);
    value.push_back(int(x));
  }
}
void CaseFile::Reader::operator()(const char* key, std::vector<std::string>& value, const FieldInfo& info) {
  const auto* n = find(key, info);
  if (!n) return;
  if (!n->is_array()) fail(*n, key, "a list of texts", info);
  value.clear();
  for (const auto& element : *n->as_array()) {
    if (!element.is_string()) fail(*n, key, "a list of texts", info);
    value.push_back(*element.value<std::string>());
    if (!info.choices.empty() && std::find(info.choices.begin(), info.choices.end(), value.back()) == info.choices.end())
      throw file_.located(InputError({.problem = "not a known choice: " + info.doc,
                                      .key = path_ + '.' + key,
                                      .value = '"' + value.back() + '"',
                                      .range = join(info.choices),
                                      .suggestion = "did you mean \"" + nearest_name(value.back(), info.choices) + "\"?"}));
  }
  if (value.size() < info.least_size) fail_size(key, info.least_size, value.size());
}

void CaseFile::Reader::renamed(const char* key, const char* instead) {
  if (!table_ || !table_->contains(key)) return;
  throw file_.located(InputError(
      {.problem = "this key is no longer read", .key = path_.empty() ? key : path_ + '.' + key, .suggestion = fmt::format("take it out: {}", instead)}));
}

void CaseFile::Reader::finish(std::span<const std::string> extra) {
  if (!table_) return;
  known_.insert(known_.end(), extra.begin(), extra.end());
  for (const auto& name : file_.names(path_)) {
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const std::string near = name_suggestion(name, known_);
    throw file_.located(InputError(
        {.problem = "unknown key", .key = path_.empty() ? name : path_ + '.' + name, .range = near.empty() ? join(known_) : "", .suggestion = near}));
  }
}

}  // namespace calomel
