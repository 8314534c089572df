#include "forward/simulation/simulator.hpp"

#include <fmt/format.h>

#include <new>

#include "base/errors.hpp"

namespace calomel {

namespace {

constexpr std::size_t few_values = 16;  ///< a model of no more values is recorded in double precision

/// The parameters by name, then further numbers by key.
std::string numbers_text(const ModelShape& shape, const RunRequest& request) {
  std::string text;
  std::map<std::string, double> further = request.numbers;
  const auto add = [&](const std::string& name, double value) { text += (text.empty() ? "" : ", ") + name + " = " + number_text(value); };
  for (const auto& p : shape.parameters) {
    const auto at = further.find(p.key);
    if (at == further.end()) continue;
    add(p.name, at->second);
    further.erase(at);
  }
  for (const auto& [key, value] : further) add(key, value);
  return text;
}

}  // namespace

RunRecord Simulator::run(const RunRequest& request) const {
  RunRecord record{.done = true};
  try {
    if (request.wanted.mean || request.wanted.pulses) {
      Prediction prediction = evaluate(request);
      const bool exact = prediction.ok && shape().values() <= few_values;
      std::vector<double> values;
      if (exact) values = prediction.mean;
      record = record_of(shape(), std::move(prediction), request.wanted.pulses);
      if (exact && record.done) record.exact = std::move(values);
    }
    if (record.done && (request.wanted.totals || request.wanted.energy_balance)) add_energies(request, record);
  } catch (const Interrupted&) {
    throw;
  } catch (const Unreachable&) {
    throw;
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    record = {.message = fmt::format("{} (at {})", e.what(), numbers_text(shape(), request))};
  }
  return record;
}

Eigen::VectorXd Simulator::gradient(std::span<const double>, std::span<const double>) const {
  expect(false, "a gradient is only requested where has_gradient() is true");
  return {};
}

bool Simulator::move_gauge(RunRequest&, std::size_t, double) const { return false; }

void Simulator::write_mesh(const std::filesystem::path&) const {
  throw InputError({.problem = "the model of this case has no mesh", .key = "--write-mesh", .suggestion = "leave it out"});
}

std::optional<PlannedCase> Simulator::planned(int, const std::vector<double>&) const { return std::nullopt; }

void Simulator::add_energies(const RunRequest&, RunRecord&) const { expect(false, "energies are only requested of a model that can give them"); }

}  // namespace calomel
