#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "inverse/data/record_rows.hpp"

namespace calomel {

namespace {

enum class Field { number, blank, text };

std::string_view trimmed(std::string_view s) {
  constexpr std::string_view space = " \t\r\"";
  const auto begin = s.find_first_not_of(space);
  return begin == std::string_view::npos ? std::string_view{} : s.substr(begin, s.find_last_not_of(space) - begin + 1);
}

std::string lowered(std::string_view s) {
  std::string out(s);
  for (auto& c : out) c = char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

Field parse_number(std::string_view s, double& value) {
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), value);
  if (error == std::errc() && end == s.data() + s.size() && std::isfinite(value)) return Field::number;
  const std::string word = lowered(s);
  value = std::numeric_limits<double>::quiet_NaN();
  return word.empty() || word == "nan" || word == "-nan" || word == "na" || word == "n/a" || word == "null" ? Field::blank : Field::text;
}

/// Walks through the lines of a text, counting them.
class Lines {
 public:
  explicit Lines(std::string_view text) : text_(text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text) {}
  bool next(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    const auto end = std::min(text_.find('\n', at_), text_.size());
    line = text_.substr(at_, end - at_);
    if (line.ends_with('\r')) line.remove_suffix(1);
    at_ = end + 1;
    ++number_;
    return true;
  }
  [[nodiscard]] int number() const { return number_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int number_ = 0;
};

void split(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  fields.clear();
  if (separator == ' ') {
    for (std::size_t i = 0; (i = line.find_first_not_of(" \t", i)) != std::string_view::npos;) {
      const auto end = std::min(line.find_first_of(" \t", i), line.size());
      fields.push_back(trimmed(line.substr(i, end - i)));
      i = end;
    }
    return;
  }
  for (std::size_t i = 0;;) {
    const auto end = std::min(line.find(separator, i), line.size());
    fields.push_back(trimmed(line.substr(i, end - i)));
    if (end == line.size()) return;
    i = end + 1;
  }
}

char separator_of(std::string_view line) {
  for (const char c : {',', ';', '\t'})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

/// "time [ms]", "time_us", "X_Value" -> seconds in its unit; empty when the column is not time.
std::optional<double> time_column(std::string_view field) {
  std::string word = lowered(field);
  std::erase_if(word, [](char c) { return c == ' ' || c == ']' || c == ')'; });
  for (auto& c : word)
    if (c == '[' || c == '(' || c == '/') c = '_';
  if (word == "x_value") return 1.0;
  const auto cut = word.find('_');
  const std::string name = word.substr(0, cut);
  if (name != "time" && name != "t") return std::nullopt;
  return cut == std::string::npos ? 1.0 : seconds_in(std::string_view(word).substr(cut + 1));
}

/// The fields of a line that may be a header: between blanks a unit in brackets belongs to the word before it, "time [us]".
void split_header(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  split(line, separator, fields);
  if (separator != ' ') return;
  std::vector<std::string_view> joined;
  for (const auto f : fields) {
    const bool unit = f.size() > 2 && ((f.front() == '[' && f.back() == ']') || (f.front() == '(' && f.back() == ')'));
    if (unit && !joined.empty())
      joined.back() = {joined.back().data(), std::size_t(f.data() + f.size() - joined.back().data())};
    else
      joined.push_back(f);
  }
  fields = std::move(joined);
}

/// The column, where it is called time and is in a unit that is no time's, "time [min]"; empty of any other.
std::string unknown_time_unit(std::string_view field) {
  const std::string word = lowered(field);
  const auto open = word.find_first_of("[(");
  if (open == std::string::npos || time_column(field)) return {};
  const auto name = trimmed(std::string_view(word).substr(0, open));
  return name == "time" || name == "t" ? std::string(field) : std::string();
}

/// A column's name without the unit that is written behind it in square brackets, "A [V]", and that unit; none where it is no unit that is known.
std::pair<std::string, std::string> name_and_unit(const std::string& column) {
  const auto open = column.find_last_of('[');
  if (open == std::string::npos || open == 0 || column.back() != ']') return {column, {}};
  const std::string unit = column.substr(open + 1, column.size() - open - 2);
  const auto known = reading_unit(unit);
  if (!known || known->quantity == "time" || unit == "1") return {column, {}};
  return {std::string(trimmed(std::string_view(column).substr(0, open))), unit};
}

/// The contents of the header line: the place of each column.
struct Header {
  char separator = ',';
  int line = 0;
  double seconds = 1;
  bool wide = false;
  int sensor = -1, pulse = -1, time = -1, condition = -1, value = -1;
  std::vector<std::string> names;
  std::string unit;  ///< of the values, if it follows the names of their columns
};

bool is_sensor_column(const std::string& word) { return word == "sensor" || word == "gauge"; }

bool looks_like_header(const std::vector<std::string_view>& fields) {
  bool time = false, sensor = false;
  for (const auto f : fields) {
    time |= time_column(f).has_value();
    sensor |= is_sensor_column(lowered(f));
  }
  return fields.size() >= 2 && ((time && sensor) || time_column(fields[0]).has_value());
}

[[noreturn]] void fail(const std::string& file, int line, std::string problem, std::string value = "", std::string suggestion = "") {
  throw InputError({.problem = std::move(problem), .value = std::move(value), .suggestion = std::move(suggestion), .file = file, .line = line});
}

Header read_header(std::string_view line, int number, const std::string& file) {
  Header h;
  h.line = number;
  h.separator = separator_of(line);
  std::vector<std::string_view> fields;
  split_header(line, h.separator, fields);
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
  std::vector<int> others;
  for (int i = 0; i < int(fields.size()); ++i) {
    const std::string word = lowered(fields[std::size_t(i)]);
    h.names.emplace_back(fields[std::size_t(i)]);
    if (is_sensor_column(word))
      h.sensor = i;
    else if (word == "pulse")
      h.pulse = i;
    else if (word == "condition")
      h.condition = i;
    else if (const auto s = time_column(word); s && h.time < 0) {
      h.time = i;
      h.seconds = *s;
    } else
      others.push_back(i);
  }
  h.wide = h.sensor < 0;
  for (const int i : others) {
    auto [name, unit] = name_and_unit(h.names[std::size_t(i)]);
    h.names[std::size_t(i)] = name;
    if (i != others.front() && unit != h.unit)
      fail(file, number, "the columns are not all in one unit", '"' + std::string(fields[std::size_t(i)]) + '"', "write them in one unit, or to one file each");
    h.unit = unit;
  }
  for (std::size_t i = 0; i < h.names.size(); ++i) {
    if (h.names[i].empty()) fail(file, number, "the header leaves a column without a name");
    for (std::size_t k = 0; k < i; ++k)
      if (h.names[i] == h.names[k]) fail(file, number, "the header names a column twice", '"' + h.names[i] + '"');
  }
  if (h.wide) {
    if (h.time != 0) fail(file, number, "a table with one column a sensor begins with the column time", '"' + h.names[0] + '"');
    if (h.pulse >= 0 || h.condition >= 0)
      fail(file, number, "a table with one column a sensor holds one pulse of one condition", "", "use the long form condition,sensor,pulse,time,strain");
    if (others.empty()) fail(file, number, "the header names no sensor");
  } else {
    if (h.time < 0) fail(file, number, "the header has no column time", "", "the long form is sensor,pulse,time,strain");
    if (others.size() != 1)
      fail(file, number, "the long form has one column of values, this header has " + std::to_string(others.size()), "",
           "the long form is sensor,pulse,time,strain");
    h.value = others[0];
  }
  return h;
}

/// LabVIEW measurement: Delta_X and X0 are in a header that ends with the second ***End_of_Header***.
struct LabviewHeader {
  std::optional<double> step;
  double start = 0;
  std::string unit;
};

LabviewHeader skip_labview_header(Lines& lines, const std::string& file) {
  LabviewHeader h;
  std::string_view line;
  std::vector<std::string_view> fields;
  for (int ends = 0; ends < 2;) {
    if (!lines.next(line)) fail(file, lines.number(), "the LabVIEW header has no second ***End_of_Header***");
    split(line, separator_of(line), fields);
    if (fields.empty()) continue;
    double value = 0;
    if (fields[0].starts_with("***End_of_Header***"))
      ++ends;
    else if (fields[0] == "Decimal_Separator" && fields.size() > 1 && fields[1] == ",")
      fail(file, lines.number(), "numbers with a decimal comma are not read", "", "export with a decimal point");
    else if (fields[0] == "Y_Unit_Label" && fields.size() > 1)
      h.unit = fields[1];
    else if ((fields[0] == "Delta_X" || fields[0] == "X0") && fields.size() > 1) {
      if (parse_number(fields[1], value) != Field::number)
        fail(file, lines.number(), "a number is expected for " + std::string(fields[0]), '"' + std::string(fields[1]) + '"');
      for (std::size_t i = 2; i < fields.size(); ++i)
        if (double other = value; !fields[i].empty() && parse_number(fields[i], other) == Field::number && other != value)
          fail(file, lines.number(), "the channels have different " + std::string(fields[0]), "", "export them to one file each");
      if (fields[0] == "X0") h.start = value;
      if (fields[0] == "Delta_X") {
        if (!(value > 0)) fail(file, lines.number(), "Delta_X must be positive", std::string(fields[1]));
        h.step = value;
      }
    }
  }
  return h;
}

/// Names to indices in order of appearance, quick when the same name comes again and again.
class Names {
 public:
  explicit Names(std::vector<std::string>& names) : names_(names) {}
  int index(std::string_view name) {
    if (last_ >= 0 && names_[std::size_t(last_)] == name) return last_;
    const auto [it, fresh] = map_.try_emplace(std::string(name), int(names_.size()));
    if (fresh) names_.emplace_back(name);
    return last_ = it->second;
  }

 private:
  std::vector<std::string>& names_;
  std::unordered_map<std::string, int> map_;
  int last_ = -1;
};

}  // namespace

std::optional<double> seconds_in(std::string_view unit) {
  if (unit.empty()) return 1;
  const auto known = reading_unit(unit);
  return known && known->quantity == "time" ? std::optional(known->size) : std::nullopt;
}

std::optional<ReadingUnit> reading_unit(std::string_view word) {
  struct Known {
    std::string_view spelling;
    ReadingUnit unit;
  };
  // Symbols keep their letters' case (mPa is not MPa), words do not.
  constexpr Known symbols[] = {{"m/m", {"strain"}},   {"m m-1", {"strain"}},      {"e", {"strain"}},           {"E", {"strain"}}, {"\xce\xb5", {"strain"}},
                               {"V", {"voltage"}},    {"Pa", {"pressure"}},       {"bar", {"pressure", 1e5}},  {"N", {"force"}},  {"m", {"length"}},
                               {"m/s", {"velocity"}}, {"m/s2", {"acceleration"}}, {"m/s^2", {"acceleration"}}, {"s", {"time"}}};
  constexpr Known words[] = {{"strain", {"strain"}}, {"volt", {"voltage"}}, {"pascal", {"pressure"}}, {"newton", {"force"}},
                             {"metre", {"length"}},  {"meter", {"length"}}, {"second", {"time"}},     {"sec", {"time"}}};
  constexpr std::pair<std::string_view, double> symbol_prefixes[] = {{"", 1},     {"n", 1e-9}, {"u", 1e-6}, {"\xc2\xb5", 1e-6}, {"\xce\xbc", 1e-6},
                                                                     {"m", 1e-3}, {"h", 1e2},  {"k", 1e3},  {"M", 1e6},         {"G", 1e9}};
  constexpr std::pair<std::string_view, double> word_prefixes[] = {{"", 1},        {"nano", 1e-9}, {"micro", 1e-6}, {"milli", 1e-3},
                                                                   {"hecto", 1e2}, {"kilo", 1e3},  {"mega", 1e6},   {"giga", 1e9}};
  const auto find = [](std::string_view text, const auto& known, const auto& prefixes) -> std::optional<ReadingUnit> {
    for (const auto& [spelling, unit] : known)
      for (const auto& [prefix, factor] : prefixes)
        if (text.size() == prefix.size() + spelling.size() && text.substr(0, prefix.size()) == prefix && text.substr(prefix.size()) == spelling)
          return ReadingUnit{unit.quantity, factor * unit.size};
    return std::nullopt;
  };
  if (word == "1") return ReadingUnit{"strain"};
  if (word == "1e-6") return ReadingUnit{"strain", 1e-6};
  if (const auto symbol = find(word, symbols, symbol_prefixes)) return symbol;
  std::string small(word);
  for (auto& c : small) c = char(std::tolower(static_cast<unsigned char>(c)));
  if (const auto name = find(small, words, word_prefixes)) return name;
  if (small.size() > 1 && small.back() == 's') return find(std::string_view(small).substr(0, small.size() - 1), words, word_prefixes);
  return std::nullopt;
}

RecordRows parse_record_text(std::string_view text, const std::string& file) {
  RecordRows out;
  out.files = {file};
  if (text.substr(0, 4096).find('\0') != std::string_view::npos)
    fail(file, 1, "this is no text file: it has zero bytes", "", "write it as text (ASCII or UTF-8), or as netCDF");
  Lines lines(text);
  std::string_view line;
  std::vector<std::string_view> fields;
  LabviewHeader labview;

  // 1. The header: the first line that names a time column.
  std::optional<Header> header;
  int skipped = 0;
  std::string first_words, strange_time;
  int first_line = 0, strange_line = 0;
  const auto of_strange_time = [&] {
    if (!strange_time.empty())
      fail(file, strange_line, "the unit of time is not known (allowed: s, ms, us, ns)", '"' + strange_time + '"', "write the times in one of these");
  };
  while (!header && lines.next(line)) {
    const auto body = trimmed(line);
    if (body.empty() || body.front() == '#') continue;
    if (body.starts_with("LabVIEW Measurement")) {
      labview = skip_labview_header(lines, file);
      out.unit = labview.unit;
      continue;
    }
    split_header(line, separator_of(line), fields);
    for (const auto f : fields)
      if (auto unit = unknown_time_unit(f); !unit.empty() && strange_time.empty()) strange_time = std::move(unit), strange_line = lines.number();
    double x = 0;
    if (fields.size() >= 2 && std::all_of(fields.begin(), fields.end(), [&](auto f) { return parse_number(f, x) != Field::text; })) {
      of_strange_time();
      fail(file, lines.number(), "missing header: numbers precede the line that names the columns", "",
           "begin with sensor,pulse,time,strain or with time and one name a sensor");
    }
    if (looks_like_header(fields)) {
      if (Lines ahead = lines; skipped > 0 && !labview.step) {  // "Time,11:57" of an instrument's own header is none
        std::string_view after;
        std::vector<std::string_view> row;
        while (ahead.next(after) && (trimmed(after).empty() || trimmed(after).front() == '#')) {
        }
        split(after, separator_of(line), row);
        const auto time = std::size_t(std::ranges::find_if(fields, [](auto f) { return time_column(f).has_value(); }) - fields.begin());
        if (row.size() != fields.size() || parse_number(row[time], x) == Field::text) {
          ++skipped;
          continue;
        }
      }
      header = read_header(line, lines.number(), file);
      break;
    }
    if (skipped++ == 0) {
      first_words = body.substr(0, 60);
      first_line = lines.number();
    }
    if (skipped > 200) break;
  }
  if (!header) {
    of_strange_time();
    if (skipped == 0) fail(file, std::max(1, lines.number()), "the file is empty");
    fail(file, first_line, "missing header: no line names the columns", '"' + first_words + '"',
         "begin with sensor,pulse,time,strain or with time and one name a sensor");
  }
  if (skipped > 0) out.warnings.push_back(std::to_string(skipped) + " lines before the header of " + file + " were skipped");

  // 2. The rows.
  const Header& h = *header;
  out.wide = h.wide;
  if (!h.unit.empty()) out.unit = h.unit;
  Names sensors(out.sensors), conditions(out.conditions);
  const bool comment = lowered(h.names.back()) == "comment";
  const std::size_t columns = h.names.size() - (comment ? 1 : 0);
  if (h.wide)
    for (std::size_t i = 1; i < columns; ++i) sensors.index(h.names[i]);
  if (h.wide) out.sensor_lines.assign(out.sensors.size(), 0);
  if (h.condition < 0) conditions.index("default");
  if (!h.wide) out.value_column = h.names[std::size_t(h.value)];
  const auto number = [&](int column, const char* what) {
    double x = 0;
    if (parse_number(fields[std::size_t(column)], x) != Field::number)
      fail(file, lines.number(), std::string("a number is expected for ") + what, '"' + std::string(fields[std::size_t(column)]) + '"');
    return x;
  };
  const auto value = [&](std::size_t column) {
    double x = 0;
    if (parse_number(fields[column], x) == Field::text)
      fail(file, lines.number(), "a number is expected in column " + h.names[column], '"' + std::string(fields[column]) + '"',
           "leave the field blank or write nan for a dropout");
    return x;
  };
  double before = -std::numeric_limits<double>::infinity();
  out.rows.reserve(text.size() / 24);
  for (std::size_t sample = 0; lines.next(line);) {
    if (const auto body = trimmed(line); body.empty() || body.front() == '#') continue;
    split(line, h.separator, fields);
    while (fields.size() > h.names.size() && fields.back().empty()) fields.pop_back();
    if (fields.size() != h.names.size() && !(comment && fields.size() == columns))
      fail(file, lines.number(),
           "this row has " + std::to_string(fields.size()) + " columns, the header (line " + std::to_string(h.line) + ") names " + std::to_string(columns));
    double time = number(h.time, "the time") * h.seconds;
    if (h.wide) {
      if (labview.step) time = labview.start + double(sample) * *labview.step;
      if (time <= before)
        fail(file, lines.number(), "the time does not increase", std::string(fields[std::size_t(h.time)]), "times that are printed rounded need more digits");
      before = time;
      for (std::size_t i = 1; i < columns; ++i) out.rows.push_back({0, int(i) - 1, 0, 0, lines.number(), time, value(i)});
    } else {
      const auto name = fields[std::size_t(h.sensor)];
      if (name.empty()) fail(file, lines.number(), "the sensor has no name");
      int pulse = 0;
      if (h.pulse >= 0) {
        const double p = number(h.pulse, "the pulse");
        if (p != std::floor(p) || std::abs(p) > 1e9)
          fail(file, lines.number(), "a whole number is expected for the pulse", std::string(fields[std::size_t(h.pulse)]));
        pulse = int(p);
      }
      const int c = h.condition < 0 ? 0 : conditions.index(fields[std::size_t(h.condition)]);
      const int s = sensors.index(name);
      if (std::size_t(s) == out.sensor_lines.size()) out.sensor_lines.push_back(lines.number());
      out.rows.push_back({c, s, pulse, 0, lines.number(), time, value(std::size_t(h.value))});
    }
    ++sample;
  }
  if (out.rows.empty()) fail(file, h.line, "there is no row below the header");
  if (labview.step)
    out.warnings.push_back("the times of " + file + " follow its Delta_X = " + number_text(*labview.step) + " s (the printed ones are rounded)");
  return out;
}

}  // namespace calomel
