// The whole base model: the linear reference box slice of ../shared/data/reference_solutions (independent finite
// differences, Richardson-extrapolated from 0.25 and 0.125 mm), relative L2 per gauge over 0.5 ms.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "forward/target/built_in_model.hpp"
#include "tests/shared_data.hpp"
#include "tests/verification/rows.hpp"
#include "tests/verification/small_runs.hpp"

using namespace calomel;
using namespace calomel::testing;

namespace {

const std::filesystem::path folder = shared_folder(CALOMEL_SOURCE_DIR) / "data" / "reference_solutions", solution = folder / "box_linear.csv";

/// Columns by name.
std::map<std::string, std::vector<double>> read_table(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line, word;
  std::getline(in, line);
  std::vector<std::string> names;
  for (std::stringstream s(line); std::getline(s, word, ',');) names.push_back(word);
  std::map<std::string, std::vector<double>> table;
  while (std::getline(in, line)) {
    std::stringstream s(line);
    for (const auto& name : names) std::getline(s, word, ','), table[name].push_back(std::stod(word));
  }
  return table;
}

struct Misfit {
  double mean = 0, worst = 0;
  int subcycles = 1;  ///< sub-cycles of the run
};

Misfit misfit(const std::vector<std::string>& overrides) {
  std::vector<std::string> all{"material.mercury.tensile_cutoff=1e15", "solver.precision=single"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  CaseFile file(folder / "case.toml", all);
  const BuiltInModel model(ForwardCase::read(file), {.pulses = 1});
  const auto run = model.simulate(solve_options(model.forward_case().solver));
  const auto reference = read_table(solution);
  Misfit m;
  m.subcycles = run.summary.subcycles;
  const auto& shape = model.shape();
  for (std::size_t k = 0; k < shape.sensors.size(); ++k) {
    const auto& r = reference.at(shape.sensors[k]);
    EXPECT_EQ(r.size(), shape.times.size());
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < r.size(); ++i) difference += std::pow(run.strain[shape.at(0, k, i)] - r[i], 2), size += r[i] * r[i];
    const double error = std::sqrt(difference / size);
    m.mean += error / double(shape.sensors.size());
    m.worst = std::max(m.worst, error);
  }
  return m;
}

bool absent() { return !std::filesystem::exists(solution); }

}  // namespace

TEST(BoxSlice, LinearLiquidFollowsTheReferenceAndConverges) {
  if (absent()) {
    rows_absent(absent_from_shared(solution));
    GTEST_SKIP() << absent_from_shared(solution);
  }
  const Misfit coarse = misfit({"geometry.element_size=0.002"}), middle = misfit({"geometry.element_size=0.001"}),
               fine = misfit({"geometry.element_size=0.0005"});
  const Misfit tied = misfit({"geometry.element_size=0.001", "geometry.wetted=tied"}),
               slower = misfit({"geometry.element_size=0.0005", "material.mercury.sound_speed=1420"});
  const Misfit cycled = misfit({"geometry.element_size=0.001", "solver.subcycles=4"});
  const double order = drawn_order("box slice", {2, 1, 0.5}, {coarse.mean, middle.mean, fine.mean});
  verify({.item = "Whole base model",
          .quantity = "linear box slice, 8 gauges over 0.5 ms, 1 mm, mean relative L2",
          .reference = 0,
          .source = "independent finite differences, own error 0.5 %",
          .measured = middle.mean,
          .tolerance = 0.05,
          .order = std::log2(coarse.mean / middle.mean),
          .control = "tied",
          .control_value = tied.mean});
  verify({.item = "Whole base model",
          .quantity = "the same, 0.5 mm",
          .reference = 0,
          .source = "the same",
          .measured = fine.mean,
          .tolerance = 0.02,
          .order = order,
          .control = "sound speed -2 %",
          .control_value = slower.mean});
  EXPECT_EQ(cycled.subcycles, 3);
  verify({.item = "Whole base model",
          .quantity = "1 mm, mercury away from the steel every 3rd step",
          .reference = 0,
          .source = "the same",
          .measured = cycled.mean,
          .tolerance = 0.05,
          .control = "tied",
          .control_value = tied.mean});
  EXPECT_LT(middle.mean, 0.45 * coarse.mean);
}

namespace {

const std::filesystem::path null_folder = shared_folder(CALOMEL_SOURCE_DIR) / "checks" / "cases" / "null";

/// Mean over the pulses of each gauge, from columns sensor, pulse, time, strain; samples in order.
std::map<std::string, std::vector<double>> mean_record(const std::filesystem::path& path) {
  std::map<std::string, std::map<double, std::pair<double, int>>> sums;
  std::ifstream in(path);
  std::string line, sensor, pulse, time, strain;
  for (std::getline(in, line); std::getline(in, line);) {
    std::stringstream s(line);
    std::getline(s, sensor, ','), std::getline(s, pulse, ','), std::getline(s, time, ','), std::getline(s, strain);
    auto& [sum, count] = sums[sensor][std::stod(time)];
    sum += std::stod(strain);
    ++count;
  }
  std::map<std::string, std::vector<double>> mean;
  for (const auto& [name, samples] : sums)
    for (const auto& [t, value] : samples) mean[name].push_back(value.first / value.second);
  return mean;
}

/// Relative L2 between the mean of eight energies and the mean record, averaged over the gauges; the worst gauge.
Misfit null_misfit(const std::string& element_size, const std::map<std::string, double>& truth) {
  CaseFile file(null_folder / "case.toml", std::vector<std::string>{"solver.precision=single", "geometry.element_size=" + element_size});
  const BuiltInModel model(ForwardCase::read(file));
  std::vector<double> theta;
  for (const auto& p : model.forward_case().parameters) theta.push_back(truth.at(p.name));
  const auto mean = model.evaluate(theta).mean;
  const auto record = mean_record(null_folder / "recordings.csv");
  const auto& shape = model.shape();
  Misfit m;
  for (std::size_t k = 0; k < shape.sensors.size(); ++k) {
    const auto& r = record.at(shape.sensors[k]);
    EXPECT_EQ(r.size(), shape.times.size());
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < r.size(); ++i) difference += std::pow(mean[shape.at(0, k, i)] - r[i], 2), size += r[i] * r[i];
    const double error = std::sqrt(difference / size);
    m.mean += error / double(shape.sensors.size());
    m.worst = std::max(m.worst, error);
  }
  return m;
}

const std::map<std::string, double> null_truth{{"density", 13501.5}, {"sound_speed", 1458.25}, {"tensile_cutoff", 188346}};

}  // namespace

// The record of another code, with small unknown errors (the steel's modulus, gauge places and gains). At 1 mm that code is itself 16 % from its own 0.5 mm
// record, and the same is allowed here.
TEST(BoxSlice, NullRecordIsMetAsCloselyAsItsOwnCodeWould) {
  if (!std::filesystem::exists(null_folder / "recordings.csv")) {
    rows_absent(absent_from_shared(null_folder / "recordings.csv"));
    GTEST_SKIP() << absent_from_shared(null_folder / "recordings.csv");
  }
  const Misfit got = null_misfit("0.001", null_truth);
  auto spoiled = null_truth;
  spoiled["sound_speed"] *= 0.9;
  verify({.item = "Null record",
          .quantity = "mean of 8 energies, 1 mm, 11 gauges over 0.47 ms, mean relative L2",
          .reference = 0,
          .source = "another code's record at 0.5 mm",
          .measured = got.mean,
          .tolerance = 0.16,
          .control = "sound speed -10 %",
          .control_value = null_misfit("0.001", spoiled).mean});
  measured("worst_gauge", got.worst);
}

TEST(BoxSlice, DISABLED_NullRecordTable) {
  for (const char* size : {"0.002", "0.001", "0.0005"}) {
    const Misfit m = null_misfit(size, null_truth);
    std::cout << size << " m: mean " << m.mean << " worst " << m.worst << std::endl;
  }
}

// test_verification --gtest_also_run_disabled_tests --gtest_filter=BoxSlice.DISABLED_*: tables of docs/verification.
TEST(BoxSlice, DISABLED_ConvergenceTable) {
  if (absent()) GTEST_SKIP() << absent_from_shared(solution);
  const char* sizes = std::getenv("CALOMEL_ELEMENT_SIZES");
  const char* extra = std::getenv("CALOMEL_OVERRIDES");
  std::vector<std::string> overrides;
  std::string word;
  if (extra)
    for (std::stringstream s(extra); s >> word;) overrides.push_back(word);
  for (std::stringstream s(sizes ? sizes : "0.002 0.001 0.0005"); s >> word;) {
    auto all = overrides;
    all.push_back("geometry.element_size=" + word);
    const Misfit m = misfit(all);
    std::cout << word << " m: mean " << m.mean << " worst " << m.worst << std::endl;
  }
}

// With the cutoff: the mean of eight energies is compared with box_riemer_mean.csv, over the whole record and over the first 100 us.
TEST(BoxSlice, DISABLED_RiemerMean) {
  if (absent()) GTEST_SKIP() << absent_from_shared(solution);
  const auto reference = read_table(folder / "box_riemer_mean.csv");
  const char* sizes = std::getenv("CALOMEL_ELEMENT_SIZES");
  std::string word;
  for (std::stringstream s(sizes ? sizes : "0.002 0.001"); s >> word;) {
    CaseFile file(folder / "case.toml", std::vector<std::string>{"solver.precision=single", "geometry.element_size=" + word});
    const BuiltInModel model(ForwardCase::read(file));
    const auto mean = model.evaluate({}).mean;
    const auto& shape = model.shape();
    for (const std::size_t samples : {shape.times.size(), std::size_t(101)}) {
      double error = 0;
      for (std::size_t k = 0; k < shape.sensors.size(); ++k) {
        const auto& r = reference.at(shape.sensors[k]);
        double difference = 0, size = 0;
        for (std::size_t i = 0; i < samples; ++i) difference += std::pow(mean[shape.at(0, k, i)] - r[i], 2), size += r[i] * r[i];
        error += std::sqrt(difference / size) / double(shape.sensors.size());
      }
      std::cout << word << " m, " << samples - 1 << " us: mean " << error << std::endl;
    }
  }
}
