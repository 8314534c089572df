#include "tests/verification/row_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/errors.hpp"

namespace calomel::testing {

const std::vector<std::string>& items() {
  static const std::vector<std::string> all{"Plane wave",
                                            "Mercury to steel",
                                            "Whole base model",
                                            "Null record",
                                            "Bending",
                                            "Simply supported plate",
                                            "Free-fixed bar",
                                            "Patch and modes",
                                            "Energy",
                                            "Pochhammer-Chree",
                                            "Fluid-filled ring",
                                            "Wet flexural waves",
                                            "Inner corner",
                                            "Slip",
                                            "Taylor plate",
                                            "Bleich-Sandler",
                                            "Water hammer",
                                            "Closing cavity",
                                            "Bubble collapse",
                                            "Bubbly dispersion",
                                            "Rear face",
                                            "Line",
                                            "Line on measured records",
                                            "Reproducibility"};
  return all;
}

namespace {

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields{""};
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

std::string quoted(const std::string& text) {
  std::string out = text;
  std::replace(out.begin(), out.end(), '"', '\'');
  return '"' + out + '"';
}

}  // namespace

std::string to_line(const Row& r) {
  return fmt::format("{},{},{},{:.9g},{},{:.9g},{:.9g},{:.9g},{},{:.9g}", quoted(r.item), quoted(r.quantity), quoted(r.unit), r.reference, quoted(r.source),
                     r.measured, r.tolerance, r.order, quoted(r.control), r.control_value);
}

Row row_from_line(const std::string& line) {
  const auto f = fields_of(line);
  if (f.size() != 10) throw InputError({.problem = fmt::format("a row of the verification has 10 fields, not {}", f.size()), .value = line});
  return {f[0], f[1], f[2], std::stod(f[3]), f[4], std::stod(f[5]), std::stod(f[6]), std::stod(f[7]), f[8], std::stod(f[9])};
}

Record read_record(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  Record record;
  for (const auto& file : files) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::string kind;
      std::getline(words, kind, ':');
      std::string rest;
      std::getline(words, rest);
      if (kind == "row") record.rows.push_back(row_from_line(rest));
      if (kind == "absent") record.absent.push_back(file.stem().string() + ": " + rest);
      if (kind == "curve") {
        const auto f = fields_of(rest);
        Curve c{f.at(0), f.at(1), {}, {}};
        for (std::size_t i = 2; i + 1 < f.size(); i += 2) c.x.push_back(std::stod(f[i])), c.y.push_back(std::stod(f[i + 1]));
        record.curves.push_back(std::move(c));
      }
    }
  }
  const auto place = [](const Row& r) { return std::find(items().begin(), items().end(), r.item) - items().begin(); };
  std::stable_sort(record.rows.begin(), record.rows.end(), [&](const Row& a, const Row& b) { return place(a) < place(b); });
  return record;
}

}  // namespace calomel::testing
