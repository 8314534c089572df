#include "apps/challenge/judged_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "apps/challenge/make.hpp"
#include "base/artefact.hpp"
#include "base/case_file.hpp"
#include "base/json.hpp"

namespace calomel::challenge {

namespace fs = std::filesystem;

namespace {

constexpr double coarse_step = 25e-6;  ///< between the values that give the strengths [s]; the Hann window is twice as long
const std::vector<std::string> families{"none", "single", "pair", "outside", "sensor"};

std::string word_of(const CaseFile& file, const std::string& key) {
  if (const auto word = file.text(key)) return *word;
  throw file.located(InputError({.problem = "a text is expected here", .key = key, .suggestion = "truth files are written by the reference generator"}));
}

double number_of(const CaseFile& file, const std::string& key) {
  if (const auto number = file.number(key)) return *number;
  throw file.located(InputError({.problem = "a number is expected here", .key = key, .suggestion = "truth files are written by the reference generator"}));
}

/// A number, not a number for null or where it is absent.
double number_or_nan(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || !found->is_number() ? std::numeric_limits<double>::quiet_NaN() : found->get<double>();
}

std::map<std::string, Interval> intervals(const Json& by_name) {
  std::map<std::string, Interval> all;
  for (const auto& [name, value] : by_name.items()) all[name] = {number_or_nan(value, "mean"), number_or_nan(value, "sd")};
  return all;
}

Finding finding_of(const Json& json) {
  Finding f;
  const std::string verdict = json.at("verdict");
  bool known = false;
  for (const VerdictKind k : {VerdictKind::none, VerdictKind::named, VerdictKind::ambiguous, VerdictKind::unknown})
    if (calomel::text(k) == verdict) {
      f.verdict = k;
      known = true;
    }
  if (!known) throw std::runtime_error("no verdict is called \"" + verdict + '"');
  f.mechanisms = json.at("mechanisms").get<std::vector<std::string>>();
  const bool names = f.verdict == VerdictKind::named || f.verdict == VerdictKind::ambiguous;
  if (names == f.mechanisms.empty()) throw std::runtime_error("the verdict \"" + verdict + "\" does not go with its mechanisms");
  f.heldout_before = number_or_nan(json.at("fit").at("before"), "heldout_nrmse");
  f.heldout_after = number_or_nan(json.at("fit").at("after"), "heldout_nrmse");
  for (const auto& entry : json.at("ranking")) {
    if (names && entry.at("name") == f.mechanisms[0] && !entry.value("heldout_tried", true))
      f.heldout_before = f.heldout_after = std::numeric_limits<double>::quiet_NaN();  // of a fault of one gauge, say
    Ranking r{.name = entry.at("name"),
              .probability = entry.at("probability"),
              .gauge = entry.value("sensor", entry.value("places", Json::object()).value("sensor_response", ""))};
    for (const auto& p : entry.at("parameters")) r.numbers[p.at("name").get<std::string>()] = {number_or_nan(p, "mean"), number_or_nan(p, "sd")};
    f.ranking.push_back(std::move(r));
  }
  f.before = intervals(json.at("base_parameters").at("before"));
  f.after = intervals(json.at("base_parameters").at("after"));
  f.runs = json.at("runs");
  f.wall = number_or_nan(json, "wall_s");
  f.settled = json.value("status", "done") == "done";
  return f;
}

}  // namespace

std::string text(Family family) { return families[std::size_t(family)]; }

Truth read_truth(const fs::path& path) {
  const CaseFile file(path);
  Truth t;
  const std::string family = word_of(file, "family");
  const auto known = std::find(families.begin(), families.end(), family);
  if (known == families.end())
    throw file.located(InputError(
        {.problem = "no family of this name", .key = "family", .range = join(families), .suggestion = "truth files are written by the reference generator"}));
  t.family = Family(known - families.begin());
  t.strength = number_of(file, "strength.decimated");
  for (const auto& name : file.names("parameter")) t.parameters[name] = number_of(file, "parameter." + name);
  std::set<std::string> mechanisms;
  for (std::size_t k = 0; k < file.count("effect"); ++k) {
    const std::string at = fmt::format("effect[{}]", k), mechanism = word_of(file, at + ".mechanism");
    t.effects.push_back(word_of(file, at + ".name"));
    if (!mechanism.empty()) mechanisms.insert(mechanism);
    if (const auto gauge = file.text(at + ".gauge")) t.gauge = *gauge;
    for (const auto& key : file.names(at + ".library")) t.numbers[mechanism + '.' + key] = number_of(file, at + ".library." + key);
  }
  if ((t.family == Family::none) != t.effects.empty())
    throw file.located(InputError(
        {.problem = "the family does not go with the effects", .key = "family", .suggestion = "truth files are written by the reference generator"}));
  if (t.family != Family::outside) t.mechanisms.assign(mechanisms.begin(), mechanisms.end());
  return t;
}

Finding read_finding(const fs::path& path) {
  const Json json = read_json(path);
  try {
    return finding_of(json);
  } catch (const std::exception& e) {
    throw InputError({.problem = std::string("is no whole diagnosis: ") + e.what(),
                      .suggestion = "take it away and run calomel challenge run again",
                      .file = path.string()});
  }
}

double noise_floor(const Recordings& r, const std::string& gauge) {
  if (r.pulses.size() < 2 || r.time.size() < 2)
    throw InputError({.problem = "a noise floor needs two pulses at least", .suggestion = "a case of a suite has some twenty", .file = r.source});
  const auto factor = std::size_t(std::max(1L, std::lround(coarse_step / (r.time[1] - r.time[0]))));
  std::vector<double> window;
  double weight = 0;
  for (std::size_t k = 1; k < 2 * factor; ++k) {
    window.push_back(std::pow(std::sin(std::numbers::pi * double(k) / (2 * double(factor))), 2));
    weight += window.back();
  }
  const auto pulses = double(r.pulses.size());
  double sum = 0, gauges = 0;
  for (std::size_t s = 0; s < r.sensors.size(); ++s) {
    if (!gauge.empty() && r.sensors[s] != gauge) continue;
    double error = 0, size = 0;
    for (std::size_t middle = factor; middle + factor <= r.time.size(); middle += factor) {
      double mean = 0, square = 0;
      for (std::size_t p = 0; p < r.pulses.size(); ++p) {
        double value = 0;
        for (std::size_t k = 0; k < window.size(); ++k) value += window[k] / weight * r.values[r.at(0, s, p, middle + k + 1 - factor)];
        mean += value / pulses;
        square += value * value / pulses;
      }
      error += std::max(0.0, square - mean * mean) / (pulses - 1);
      size += mean * mean;
    }
    sum += std::sqrt(error / size);
    ++gauges;
  }
  if (gauges == 0) throw InputError({.problem = "no gauge of this name is recorded", .value = '"' + gauge + '"', .range = join(r.sensors), .file = r.source});
  return sum / gauges;
}

std::vector<JudgedCase> read_judged(const fs::path& directory, std::vector<std::string>& waiting) {
  std::vector<JudgedCase> all;
  for (const auto& name : cases_in(directory)) {
    const fs::path diagnosis = directory / "results" / name / "diagnosis.json", truth = directory / "truth" / (name + ".toml");
    if (!fs::exists(diagnosis)) {
      waiting.push_back(name);
      continue;
    }
    if (!fs::exists(truth))
      throw InputError(
          {.problem = "the truth of a diagnosed case is not there", .suggestion = "put the folder truth/ back beside cases/", .file = truth.string()});
    JudgedCase c{.name = name, .truth = read_truth(truth), .finding = read_finding(diagnosis)};
    if (!c.truth.effects.empty())
      c.noise_floor = noise_floor(read_recordings_file(directory / "cases" / name / "recordings.csv"), c.truth.family == Family::sensor ? c.truth.gauge : "");
    all.push_back(std::move(c));
  }
  if (all.empty())
    throw InputError({.problem = "no case has a diagnosis yet", .suggestion = "run: calomel challenge run " + directory.string(), .file = directory.string()});
  return all;
}

namespace {

Json intervals_json(const std::map<std::string, Interval>& all) {
  Json out = Json::object();
  for (const auto& [name, x] : all) out[name] = {{"mean", number(x.mean)}, {"sd", number(x.sd)}};
  return out;
}

Json ranking_json(const std::vector<Ranking>& ranking) {
  Json out = Json::array();
  for (const auto& r : ranking) {
    Json parameters = Json::array();
    for (const auto& [name, x] : r.numbers) parameters.push_back({{"name", name}, {"mean", number(x.mean)}, {"sd", number(x.sd)}});
    out.push_back({{"name", r.name}, {"probability", r.probability}, {"sensor", r.gauge}, {"parameters", parameters}});
  }
  return out;
}

JudgedCase judged_of(const Json& json) {
  JudgedCase c{.name = json.at("name"), .finding = finding_of(json.at("finding")), .noise_floor = json.at("noise_floor")};
  const std::string family = json.at("family");
  const auto known = std::find(families.begin(), families.end(), family);
  if (known == families.end()) throw std::runtime_error("no family is called \"" + family + '"');
  c.truth = {.family = Family(known - families.begin()),
             .mechanisms = json.at("mechanisms"),
             .effects = json.at("effects"),
             .gauge = json.at("gauge"),
             .strength = json.at("strength"),
             .parameters = json.at("parameters"),
             .numbers = json.at("numbers")};
  return c;
}

}  // namespace

Json judged_json(const JudgedCase& c) {
  const Finding& f = c.finding;
  return {{"name", c.name},
          {"family", text(c.truth.family)},
          {"effects", c.truth.effects},
          {"mechanisms", c.truth.mechanisms},
          {"gauge", c.truth.gauge},
          {"strength", c.truth.strength},
          {"parameters", c.truth.parameters},
          {"numbers", c.truth.numbers},
          {"noise_floor", c.noise_floor},
          {"finding",  // the parts of diagnosis.json that are scored, by its keys
           {{"verdict", calomel::text(f.verdict)},
            {"mechanisms", f.mechanisms},
            {"ranking", ranking_json(f.ranking)},
            {"fit", {{"before", {{"heldout_nrmse", number(f.heldout_before)}}}, {"after", {{"heldout_nrmse", number(f.heldout_after)}}}}},
            {"base_parameters", {{"before", intervals_json(f.before)}, {"after", intervals_json(f.after)}}},
            {"runs", f.runs},
            {"wall_s", number(f.wall)},
            {"status", f.settled ? "done" : "not_settled"}}}};
}

std::vector<JudgedCase> read_scored(const fs::path& path, std::string& rule_hash) {
  const Json json = read_json(path);
  try {
    rule_hash = json.at("rule").at("hash");
    std::vector<JudgedCase> all;
    for (const auto& c : json.at("list")) all.push_back(judged_of(c));
    return all;
  } catch (const std::exception& e) {
    throw InputError({.problem = std::string("is no score of a suite with its rule: ") + e.what(),
                      .suggestion = "give a score.json that calomel challenge score has written",
                      .file = path.string()});
  }
}

}  // namespace calomel::challenge
