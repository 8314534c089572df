/// Holds a finished study of an example against what the example must show: check_calibration OUT_DIR TRUTH.toml [options]
///
/// Every run of the campaign is there; in the true model the calibrated parameters beat the nominal ones in accuracy and in
/// MAE; the parameters (or the impedance) that are named lie near the true ones; the report is made. Exit status 1 when one of these fails.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <vector>

#include "base/artefact.hpp"
#include "base/case_file.hpp"
#include "base/errors.hpp"
#include "base/json.hpp"

namespace {

using namespace calomel;

struct Expected {
  std::map<std::string, double> within;  ///< greatest distance of a parameter, or of "impedance", from the true one [%]
  double least_accuracy = 0;             ///< [%] mean over the sensors
  double least_gain = 0;                 ///< [%] accuracy, calibrated less nominal
  double greatest_mae_ratio = 1;         ///< calibrated over nominal
  bool compared = false;                 ///< comparison.json holds all three methods
  double posterior = 0;                  ///< greatest distance of posterior means from the true values, in posterior sds; 0: none was sampled
};

/// One line a check; counts the failed ones.
class Checks {
 public:
  void operator()(bool holds, const std::string& what) {
    fmt::print("{}  {}\n", holds ? "ok    " : "FAILED", what);
    failed_ += holds ? 0 : 1;
  }
  [[nodiscard]] int failed() const { return failed_; }

 private:
  int failed_ = 0;
};

/// comparison.json repeats what the three calibrations say, each of them beats the nominal parameters by its own objective, and the report shows their
/// differences.
void check_comparison(const std::filesystem::path& out, Checks& holds) {
  const Json comparison = read_json(out / "comparison.json");
  holds(comparison.at("methods") == Json({"enc", "spe", "map"}), "comparison.json: enc, spe and map");
  for (const auto& method : comparison.at("methods")) {
    const auto name = method.get<std::string>();
    const Json summary = read_json(out / (name + ".json"));
    bool same = true;
    for (const auto& row : comparison.at("parameters"))
      same = same &&
             row.at(name) == (row.at("name") == "impedance" ? summary.at("impedance").at("value") : summary.at("theta").at(row.at("name").get<std::string>()));
    const Json::json_pointer own("/mesh/working_mesh");  // compared on the case's mesh unless all three report that of the finer mesh
    const Json& scores = comparison.at("scores_on") != summary.at("scores_on") && summary.contains(own) ? summary.at(own) : summary;
    for (const char* table : {"accuracy", "mae"}) same = same && comparison.at(table).back().at(name) == scores.at(table);
    holds(same, fmt::format("comparison.json: the parameters and scores of {} are those of {}.json", name, name));
    const Json& objective = summary.at("objective");
    const double value = objective.at("value").get<double>(), nominal = objective.at("nominal").get<double>();
    holds(objective.at("sense") == "minimise" ? value < nominal : value > nominal,
          fmt::format("{}: {} {:.5g}, nominal {:.5g}", name, objective.at("name").get<std::string>(), value, nominal));
  }
  bool sds = true;
  for (const auto& pair : comparison.at("agreement")) sds = sds && pair.at("largest_in_map_sd").is_number();
  bool placed = comparison.at("in_posterior").size() == 2;  // ENC and SPE
  for (const auto& row : comparison.at("in_posterior")) placed = placed && row.at("distance").is_number() && row.at("share_nearer").is_number();
  holds(sds && placed && comparison.at("agreement").size() == 3, comparison.at("sentence").get<std::string>());
  holds(read_text(out / "report.html").find("How far the calibrations lie apart") != std::string::npos, "report.html shows how far they lie apart");
}

/// The chains have converged, the true model agrees with the emulator, and the truth lies within the posterior.
void check_posterior(const std::filesystem::path& out, const std::function<double(const std::string&)>& true_value, const std::vector<std::string>& names,
                     double most_sds, Checks& holds) {
  const Json posterior = read_json(out / "posterior.json");
  holds(posterior.at("converged").get<bool>(), "posterior.json: " + posterior.at("message").get<std::string>());
  const Json& mode = posterior.at("mode");
  holds(mode.at("settled").get<bool>(), "the emulator " + mode.at("message").get<std::string>());
  holds(posterior.at("true_model_check").at("holds").get<bool>(), posterior.at("true_model_check").at("sentence").get<std::string>());
  for (const auto& p : posterior.at("parameters")) {
    const auto name = p.at("name").get<std::string>();
    const double mean = p.at("mean").get<double>(), sd = p.at("sd").get<double>();
    if (std::find(names.begin(), names.end(), name) == names.end()) continue;
    const double z = (mean - true_value(name)) / sd;
    holds(std::abs(z) <= most_sds,
          fmt::format("posterior: {} {:.5g} ± {:.2g}, {:+.1f} sd from the true {:.5g} (within {:.1f})", name, mean, sd, z, true_value(name), most_sds));
  }
  holds(std::filesystem::exists(out / "posterior.nc"), "posterior.nc stands");
}

int check(const std::filesystem::path& out, const std::filesystem::path& truth_path, const Expected& expected) {
  Checks holds;
  const Json campaign = read_json(out / "campaign.json");
  holds(campaign.at("failed") == 0 && campaign.at("completed") == campaign.at("runs"),
        fmt::format("campaign: {} of {} runs completed", campaign.at("completed").get<int>(), campaign.at("runs").get<int>()));

  const Json enc = read_json(out / "enc.json");
  holds(enc.at("status") == "done", fmt::format("calibration: {}", enc.at("message").get<std::string>()));
  const auto number = [&](const char* key) { return enc.at(key).get<double>(); };
  const double accuracy = number("accuracy"), nominal_accuracy = number("nominal_accuracy"), mae = number("mae"), nominal_mae = number("nominal_mae");
  holds(accuracy >= expected.least_accuracy, fmt::format("accuracy {:.1f} % (at least {:.1f} %)", accuracy, expected.least_accuracy));
  holds(accuracy - nominal_accuracy >= expected.least_gain,
        fmt::format("accuracy {:.1f} % above the nominal {:.1f} % (at least {:.1f} %)", accuracy - nominal_accuracy, nominal_accuracy, expected.least_gain));
  holds(mae <= expected.greatest_mae_ratio * nominal_mae,
        fmt::format("MAE {:.2f} microstrain, nominal {:.2f} (at most {:.2f} of it)", mae, nominal_mae, expected.greatest_mae_ratio));

  const CaseFile truth(truth_path);
  const auto true_value = [&](const std::string& name) {
    const auto value = truth.number("parameter." + name);
    if (!value) throw InputError({.problem = "no true value", .key = "parameter." + name, .file = truth_path.string()});
    return *value;
  };
  std::map<std::string, std::array<double, 3>> values;  // recovered, true, nominal
  for (const auto& [name, value] : enc.at("theta").items()) values[name] = {value.get<double>(), true_value(name), enc.at("nominal").at(name).get<double>()};
  const Json& z = enc.at("impedance");
  values["impedance"] = {z.at("value").get<double>(), true_value("density") * true_value("sound_speed"), z.at("nominal").get<double>()};
  for (const auto& [name, percent] : expected.within)
    if (!values.contains(name)) throw InputError({.problem = "no parameter of the calibration", .key = "--within", .value = name});
  for (const auto& [name, v] : values) {
    const double error = 100 * (v[0] / v[1] - 1);
    const std::string line = fmt::format("{}: recovered {:.5g}, {:+.1f} % of the true {:.5g}, nominal {:.5g}", name, v[0], error, v[1], v[2]);
    if (const auto limit = expected.within.find(name); limit != expected.within.end())
      holds(std::abs(error) <= limit->second, fmt::format("{} (within {:.1f} %)", line, limit->second));
    else
      fmt::print("        {}\n", line);
  }

  const std::string page = std::filesystem::exists(out / "report.html") ? read_text(out / "report.html") : "";
  bool named = page.find("</html>") != std::string::npos;
  for (const auto& s : enc.at("sensors")) named = named && page.find('"' + s.at("name").get<std::string>() + '"') != std::string::npos;
  holds(named, fmt::format("report.html is whole and names every sensor ({} bytes)", page.size()));
  if (expected.compared) check_comparison(out, holds);
  if (expected.posterior > 0) {
    std::vector<std::string> names;
    for (const auto& [name, value] : enc.at("theta").items()) names.push_back(name);
    check_posterior(out, true_value, names, expected.posterior, holds);
  }
  return holds.failed();
}

}  // namespace

int main(int argc, char** argv) try {
  std::filesystem::path out, truth;
  Expected expected;
  CLI::App app("Holds a finished study against what its example must show.", "check_calibration");
  app.add_option("OUT", out)->required();
  app.add_option("TRUTH", truth)->required();
  std::vector<std::string> within;
  app.add_option("--within", within, "parameter (or impedance) and its greatest distance from the true one [%]; may be repeated")->type_name("NAME=PERCENT");
  app.add_option("--least-accuracy", expected.least_accuracy, "[%]")->required();
  app.add_option("--least-gain", expected.least_gain, "[%] of accuracy over nominal")->required();
  app.add_option("--greatest-mae-ratio", expected.greatest_mae_ratio, "MAE over the nominal one")->required();
  app.add_flag("--compared", expected.compared, "hold comparison.json against the three calibrations, too");
  app.add_option("--posterior", expected.posterior, "hold posterior.json against the true values: the most posterior standard deviations");
  CLI11_PARSE(app, argc, argv);
  for (const auto& text : within) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) throw InputError({.problem = "NAME=PERCENT is expected", .key = "--within", .value = text});
    expected.within[text.substr(0, equals)] = std::stod(text.substr(equals + 1));
  }
  return check(out, truth, expected) == 0 ? 0 : 1;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
}
