/// Holds a finished study of an example against what the example must show: check_calibration OUT_DIR TRUTH.toml [options]
///
/// Every run of the campaign is there; in the true model the calibrated parameters beat the nominal ones in accuracy and in
/// MAE; they lie where they may; the impedance is recovered; the report is made. Exit status 1 when one of these fails.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>

#include "base/artefact.hpp"
#include "base/case_file.hpp"
#include "base/errors.hpp"

namespace {

using namespace calomel;

struct Expected {
  double impedance_within = 0;    ///< [%] of the true one
  double least_accuracy = 0;      ///< [%] mean over the sensors
  double least_gain = 0;          ///< [%] accuracy, calibrated less nominal
  double greatest_mae_ratio = 1;  ///< calibrated over nominal
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
  for (const auto& [name, value] : enc.at("theta").items())
    fmt::print("        {}: recovered {:.5g}, true {:.5g}, nominal {:.5g}\n", name, value.get<double>(), true_value(name),
               enc.at("nominal").at(name).get<double>());
  const double z = enc.at("impedance").at("value"), true_z = true_value("density") * true_value("sound_speed");
  const double error = 100 * (z / true_z - 1);
  holds(std::abs(error) <= expected.impedance_within,
        fmt::format("impedance {:.3f} MRayl, {:+.2f} % of the true {:.3f} (within {:.1f} %)", z / 1e6, error, true_z / 1e6, expected.impedance_within));

  const std::string page = std::filesystem::exists(out / "report.html") ? read_text(out / "report.html") : "";
  bool named = page.find("</html>") != std::string::npos;
  for (const auto& s : enc.at("sensors")) named = named && page.find('"' + s.at("name").get<std::string>() + '"') != std::string::npos;
  holds(named, fmt::format("report.html is whole and names every sensor ({} bytes)", page.size()));
  return holds.failed();
}

}  // namespace

int main(int argc, char** argv) try {
  std::filesystem::path out, truth;
  Expected expected;
  CLI::App app("Holds a finished study against what its example must show.", "check_calibration");
  app.add_option("OUT", out)->required();
  app.add_option("TRUTH", truth)->required();
  app.add_option("--impedance-within", expected.impedance_within, "[%] of the true impedance")->required();
  app.add_option("--least-accuracy", expected.least_accuracy, "[%]")->required();
  app.add_option("--least-gain", expected.least_gain, "[%] of accuracy over nominal")->required();
  app.add_option("--greatest-mae-ratio", expected.greatest_mae_ratio, "MAE over the nominal one")->required();
  CLI11_PARSE(app, argc, argv);
  return check(out, truth, expected) == 0 ? 0 : 1;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
}
