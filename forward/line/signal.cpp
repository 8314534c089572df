#include "forward/line/signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "base/finite_number.hpp"
#include "base/input_file.hpp"

namespace calomel {

namespace {

std::vector<std::string> words_of(std::string line) {
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string w; in >> w && w[0] != '#';) words.push_back(w);
  return words;
}

}  // namespace

Signal read_signal(const std::filesystem::path& path, int column, std::optional<double> sample_interval, const std::string& key) {
  std::ifstream in = input_file(key, path);
  Signal signal;
  std::vector<double> time;
  std::vector<int> lines;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const auto words = words_of(line);
    if (words.empty()) continue;
    const auto fail = [&](const std::string& problem) {
      return InputError({.problem = problem, .value = '"' + line.substr(0, 60) + '"', .file = path.string(), .line = number});
    };
    const auto t = finite_number(words[0]);
    if (!t && time.empty()) continue;  // a header
    if (!t) throw fail("a time [s] is expected in the first column");
    if (words.size() < std::size_t(column)) throw fail(fmt::format("column {} is wanted, there are {}", column, words.size()));
    const auto value = finite_number(words[std::size_t(column - 1)]);
    if (!value) throw fail(fmt::format("a number is expected in column {}", column));
    time.push_back(*t);
    signal.value.push_back(*value);
    lines.push_back(number);
  }
  const std::size_t n = time.size();
  if (n < 4) throw InputError({.problem = "holds fewer than four samples", .file = path.string()});
  signal.begin = time[0];
  signal.interval = sample_interval.value_or((time[n - 1] - time[0]) / double(n - 1));
  if (!(signal.interval > 0))
    throw InputError({.problem = "time must increase", .value = number_text(time[n - 1]), .file = path.string(), .line = lines[n - 1]});
  if (!sample_interval)
    for (std::size_t i = 0; i < n; ++i)
      if (std::abs(time[i] - time[0] - double(i) * signal.interval) > 0.1 * signal.interval)
        throw InputError({.problem = fmt::format("times are not evenly spaced: {} s is expected here", number_text(time[0] + double(i) * signal.interval)),
                          .value = number_text(time[i]),
                          .suggestion = "where printed times are rounded, set drive.sample_interval",
                          .file = path.string(),
                          .line = lines[i]});
  return signal;
}

Signal read_drive(const std::filesystem::path& path, const DriveOptions& options) {
  Signal s = read_signal(path, options.column, options.sample_interval, "drive.file");
  double mean = 0;
  if (options.baseline > 0) {
    const auto quiet = std::min(s.value.size(), std::size_t(options.baseline / s.interval));
    if (quiet == 0)
      throw InputError({.problem = fmt::format("the baseline is shorter than the time between samples, {} s", number_text(s.interval)),
                        .key = "drive.baseline",
                        .value = number_text(options.baseline)});
    for (std::size_t i = 0; i < quiet; ++i) mean += s.value[i] / double(quiet);
  }
  for (auto& v : s.value) v = options.scale * (v - mean);
  return s;
}

}  // namespace calomel
