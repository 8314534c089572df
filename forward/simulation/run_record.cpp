#include "forward/simulation/run_record.hpp"

#include <fmt/format.h>

#include <cmath>
#include <new>

#include "base/frame_file.hpp"

namespace calomel {

namespace {

std::string point_text(const ModelShape& shape, std::span<const double> theta) {
  std::string text;
  for (std::size_t i = 0; i < theta.size(); ++i) text += (i ? ", " : "") + shape.parameters[i].name + " = " + number_text(theta[i]);
  return text;
}

/// Why a prediction cannot be kept; empty when it can.
std::string fault(const ModelShape& shape, const Prediction& p) {
  const auto n = shape.values();
  if (p.mean.size() != n) return fmt::format("the model gave {} values, {} are expected", p.mean.size(), n);
  if (!p.energy_slope.empty() && p.energy_slope.size() != n) return fmt::format("the model gave {} energy slopes, {} are expected", p.energy_slope.size(), n);
  if (!p.scatter.empty() && p.scatter.size() != n) return fmt::format("the model gave {} scatters, {} are expected", p.scatter.size(), n);
  if (!p.pulses.empty() && p.pulses.size() != n * p.energies.size())
    return fmt::format("the model gave {} values of single pulses, {} are expected", p.pulses.size(), n * p.energies.size());
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(float(p.mean[i]))) {
      const auto sensor = i / shape.times.size() % shape.sensors.size();
      return fmt::format("the value at sensor {}, time {:g} s is not finite", shape.sensors[sensor], shape.times[i % shape.times.size()]);
    }
  return "";
}

std::vector<float> single(const std::vector<double>& values) { return {values.begin(), values.end()}; }

}  // namespace

Eigen::VectorXd RunRecord::history() const {
  if (!exact.empty()) return Eigen::Map<const Eigen::VectorXd>(exact.data(), Eigen::Index(exact.size()));
  return Eigen::Map<const Eigen::VectorXf>(mean.data(), Eigen::Index(mean.size())).cast<double>();
}

Prediction RunRecord::prediction() const {
  const auto values = history();
  return {.ok = done, .lost = lost, .message = message, .mean = {values.begin(), values.end()}};
}

RunRecord record_of(const ModelShape& shape, Prediction p, bool keep_pulses) {
  RunRecord record;
  record.message = p.ok ? fault(shape, p) : p.message.empty() ? "the model gave no reason" : p.message;
  record.done = record.message.empty();
  record.lost = p.lost;
  if (!record.done) return record;
  record.mean = single(p.mean);
  record.energy_slope = single(p.energy_slope);
  record.scatter = single(p.scatter);
  if (keep_pulses) {
    record.pulses = std::move(p.pulses);
    record.energies = std::move(p.energies);
  }
  return record;
}

RunRecord evaluate_run(const ForwardModel& model, std::span<const double> theta, bool keep_pulses) {
  try {
    return record_of(model.shape(), model.evaluate(theta), keep_pulses);
  } catch (const InputError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const Unreachable&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    return {.message = fmt::format("{} (at {})", e.what(), point_text(model.shape(), theta))};
  }
}

std::string bytes_of(const RunRecord& r) {
  ByteWriter out;
  out.value(std::uint8_t(r.done));
  out.text(r.message);
  for (const auto* values : {&r.mean, &r.energy_slope, &r.scatter, &r.pulses}) out.values(std::span<const float>(*values));
  out.values(r.energies);
  // What few records have comes last, so that a record without them is written as it always was.
  const std::vector<double>* rest[] = {&r.totals, &r.energy_balance, &r.exact};
  std::size_t last = std::size(rest);
  while (last > 0 && rest[last - 1]->empty()) --last;
  for (std::size_t i = 0; i < last; ++i) out.values(*rest[i]);
  return std::move(out.bytes);
}

RunRecord record_of(std::string_view bytes) {
  ByteReader in(bytes);
  RunRecord r;
  r.done = in.value<std::uint8_t>() != 0;
  r.message = in.text();
  for (auto* values : {&r.mean, &r.energy_slope, &r.scatter, &r.pulses}) *values = in.values<float>();
  r.energies = in.values<double>();
  for (auto* values : {&r.totals, &r.energy_balance, &r.exact})
    if (!in.at_end()) *values = in.values<double>();
  return r;
}

}  // namespace calomel
