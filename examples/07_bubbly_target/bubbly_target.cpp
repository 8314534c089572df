/// What the example shows, out of the artefacts of its studies.
///   bubbly_target numbers OUT/diagnosis.json                      the named numbers as --set arguments, a line each
///   bubbly_target table OUT OUT_WITH [expected.csv]               the answers side by side; exit status 1 where one is not as expected
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string>

#include "base/artefact.hpp"
#include "base/json.hpp"
#include "examples/expected.hpp"

namespace {

using namespace calomel;

/// What the recordings were made with, examples/recorder/bubbly_target.spec.toml; the last by its two sizes of bubble together.
const std::map<std::string, double> truth{{"tensile_cutoff", 180e3}, {"density", 13480}, {"sound_speed", 1452}, {"bubbly_liquid.alpha0", 1.0447e-4}};

const Json& entry(const Json& diagnosis, const std::string& name) {
  for (const auto& r : diagnosis.at("ranking"))
    if (r.at("name") == name) return r;
  throw std::runtime_error("diagnosis.json ranks no " + name);
}

void print_numbers(const std::filesystem::path& file) {
  const Json d = read_json(file);
  for (const auto& mechanism : d.at("mechanisms")) {
    const auto name = mechanism.get<std::string>();
    fmt::print("--set\nmechanism.{}.enabled=true\n", name);
    for (const auto& p : entry(d, name).at("parameters"))
      fmt::print("--set\nmechanism.{}={:.4g}\n", p.at("name").get<std::string>(), p.at("mean").get<double>());
  }
}

bool print_table(const std::filesystem::path& out, const std::filesystem::path& with, const std::string& expected) {
  const Json d = read_json(out / "diagnosis.json");
  std::map<std::string, double> found;
  fmt::print("{:<28} {:>14} {:>12} {:>12} {:>14}\n", "", "tensile cutoff", "density", "sound speed", "accuracy [%]");
  const auto row = [&](const std::string& name, const auto& value_of, const Json& accuracy) {
    fmt::print("{:<28} {:>14.0f} {:>12.0f} {:>12.1f} {:>14}\n", name, value_of("tensile_cutoff"), value_of("density"), value_of("sound_speed"),
               accuracy.is_number() ? fmt::format("{:.1f}", accuracy.get<double>()) : "");
  };
  row(
      "truth", [](const std::string& p) { return truth.at(p); }, Json());
  for (const auto& [label, folder] : {std::pair{"without bubbles", out}, std::pair{"with bubbles", with}})
    for (const std::string method : {"enc", "spe"}) {
      if (!std::filesystem::exists(folder / (method + ".json"))) continue;
      const Json s = read_json(folder / (method + ".json"));
      const auto value = [&](const std::string& p) { return found[fmt::format("{} {} {}", method, label, p)] = s.at("theta").at(p).get<double>(); };
      row(fmt::format("{}, {}", method == "enc" ? "ENC" : "SPE", label), value, s.at("accuracy"));
      found[fmt::format("{} {} accuracy", method, label)] = s.at("accuracy").get<double>();
    }
  for (const std::string when : {"before", "after"}) {
    const Json& of = d.at("base_parameters").at(when);
    const auto value = [&](const std::string& p) { return found["diagnosis " + when + ' ' + p] = of.at(p).at("mean").get<double>(); };
    row("diagnosis, " + when + " naming", value, d.at("fit").at(when).at("accuracy"));
    found["held-out misfit " + when] = d.at("fit").at(when).at("heldout_nrmse").get<double>();
  }
  found["verdict " + d.at("verdict").get<std::string>()] = 1;
  for (const auto& m : d.at("mechanisms")) found["named " + m.get<std::string>()] = 1;
  fmt::print("\n{}\n\n", d.at("summary").get<std::string>());
  for (const auto& p : entry(d, "bubbly_liquid").at("parameters")) {
    const auto name = p.at("name").get<std::string>();
    found[name] = p.at("mean").get<double>();
    fmt::print("{:<34} {:.3g} ± {:.2g}{}\n", name, p.at("mean").get<double>(), p.at("sd").get<double>(),
               truth.contains(name) ? fmt::format("   true {:.3g}", truth.at(name)) : "");
  }
  return expected.empty() || examples::as_expected(found, expected);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string verb = argc > 2 ? argv[1] : "";
  if (verb == "numbers") {
    print_numbers(argv[2]);
    return 0;
  }
  if (verb == "table" && argc > 3) return print_table(argv[2], argv[3], argc > 4 ? argv[4] : "") ? 0 : 1;
  fmt::print(stderr, "bubbly_target numbers OUT/diagnosis.json\nbubbly_target table OUT OUT_WITH [expected.csv]\n");
  return 2;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
}
