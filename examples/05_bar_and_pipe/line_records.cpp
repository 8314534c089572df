// The records of this example, by other formulas than the library's; a measured one made ready; a diagnosis as a table.
//
//   line_records bar OUT.csv        two gauges of a bar: rod theory of Mindlin and Herrmann by finite differences
//   line_records pipe OUT.csv       a closing valve: liquid without tensile strength, by finite differences
//   line_records trace TRACE OUT    a digitised trace (time, pressure; in any order) -> even times of 1 ms
//   line_records table OUT/diagnosis.json [expected.csv]
//
// Nothing of forward/ is used.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "base/artefact.hpp"
#include "base/errors.hpp"
#include "base/json.hpp"
#include "base/random.hpp"
#include "examples/expected.hpp"

using namespace calomel;

namespace {

/// A round bar of steel, its true numbers.
constexpr double young = 203e9, bar_density = 7850, poisson = 0.29, radius = 0.010, first_gauge = 0.6, travel = 1.2;

/// Mindlin and Herrmann 1951 (Graff 1975, section 8.3): axial displacement u and radial displacement w at the surface,
///   rho u_tt = (lambda + 2 mu) u_xx + (2 lambda / a) w_x,
///   rho w_tt = kappa^2 mu w_xx - (8 k1^2 / a^2) (lambda + mu) w - (4 k1^2 lambda / a) u_x,
/// kappa by Rayleigh's speed of short waves, k1 so that long waves disperse as in the exact theory. Central differences, w between the nodes of u.
std::string bar_record() {
  constexpr double dx = 0.5e-3, dt = 5e-8, sample = 5e-7, end = 500e-6, length = 3.6;
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), mu = young / (2 * (1 + poisson));
  const double kappa2 = std::pow((0.87 + 1.12 * poisson) / (1 + poisson), 2), k2 = 1 - kappa2 * mu / young;
  const auto n = std::size_t(length / dx);
  std::vector<double> u(n + 1), u_rate(n + 1), w(n), w_rate(n);
  const auto gauge = [&](double x) { return (u[std::size_t(std::lround(x / dx)) + 1] - u[std::size_t(std::lround(x / dx)) - 1]) / (2 * dx); };
  const auto push = [](double t) {  // velocity of the struck end over the greatest
    constexpr double rise = 18e-6, plateau = 60e-6;
    const auto ramp = [](double s) { return s <= 0 ? 0.0 : s >= 1 ? 1.0 : 0.5 * (1 - std::cos(std::numbers::pi * s)); };
    return ramp(t / rise) - ramp((t - rise - plateau) / rise);
  };
  const double speed = std::sqrt(young / bar_density);
  RandomStream noise(5, 0);
  std::string text = "# made by examples/05_bar_and_pipe/line_records; volts, tension positive\ntime,first,second\n";
  const auto every = std::size_t(std::lround(sample / dt));
  for (std::size_t step = 0; double(step) * dt <= end + 0.5 * dt; ++step) {
    if (step % every == 0)  // a bridge of 1000 V per strain; the second gauge's clock lags by 0.2 us
      text += fmt::format("{:.7f},{:.5f},", double(step) * dt, 1e3 * gauge(first_gauge) + 0.5e-3 * noise.normal());
    if (step % every == 0) text += fmt::format("{:.5f}\n", 0.988 * 1e3 * gauge(first_gauge + travel) + 0.002 + 0.5e-3 * noise.normal());
    for (std::size_t i = 1; i < n; ++i)
      u_rate[i] += dt / bar_density * ((lambda + 2 * mu) * (u[i + 1] - 2 * u[i] + u[i - 1]) / (dx * dx) + 2 * lambda / radius * (w[i] - w[i - 1]) / dx);
    u_rate[0] = 1e-3 * speed * push(double(step) * dt - 10e-6);  // 1e-3 strain, compressive
    for (std::size_t i = 0; i < n; ++i) {
      const double bend = i > 0 && i + 1 < n ? (w[i + 1] - 2 * w[i] + w[i - 1]) / (dx * dx) : 0;
      w_rate[i] +=
          dt / bar_density * (kappa2 * mu * bend - 8 * k2 / (radius * radius) * (lambda + mu) * w[i] - 4 * k2 * lambda / radius * (u[i + 1] - u[i]) / dx);
    }
    for (std::size_t i = 0; i < n; ++i) u[i] += dt * u_rate[i], w[i] += dt * w_rate[i];
  }
  return text;
}

/// A pipe of water, its true numbers.
constexpr double pipe_length = 40, diameter = 0.022, wave_speed = 1290, water = 998.2, velocity = 0.42, reservoir = 210e3, friction = 0.031, closing = 0.008,
                 vapour = -99e3;

/// p = max(p_v, p_0 + rho a^2 e) in each of many cells, e what has flowed into it over its volume, void and all: rho V_t + p_x + rho f V|V| / 2D = 0 between
/// the cells, leapfrog, with a viscous pressure of a cell's length where liquid closes in.
std::string pipe_record() {
  constexpr std::size_t cells = 400;
  constexpr double dx = pipe_length / cells, dt = 0.8 * dx / wave_speed, sample = 1e-3, end = 0.6;
  const double loss = water * friction * velocity * velocity / (2 * diameter), at_valve = reservoir - loss * pipe_length;
  std::vector<double> steady(cells), e(cells), v(cells + 1, velocity), p(cells);
  for (std::size_t i = 0; i < cells; ++i) p[i] = steady[i] = reservoir - loss * dx * (double(i) + 0.5);
  RandomStream noise(5, 1);
  std::string text = "# made by examples/05_bar_and_pipe/line_records; gauge pressure at the valve\ntime,valve\n0,";
  text += fmt::format("{:.1f}\n", 1e-3 * at_valve);
  double next = sample;
  double mean = 0;
  double valve = at_valve;
  std::size_t count = 0;
  for (std::size_t step = 0; double(step) * dt <= end; ++step) {
    const double t = double(step) * dt, opening = std::max(0.0, 1 - t / closing);
    v[0] -= dt / (water * 0.5 * dx) * (p[0] - reservoir) + dt * friction * v[0] * std::abs(v[0]) / (2 * diameter);
    for (std::size_t i = 1; i < cells; ++i) v[i] -= dt / (water * dx) * (p[i] - p[i - 1]) + dt * friction * v[i] * std::abs(v[i]) / (2 * diameter);
    v[cells] = velocity * opening * std::copysign(std::sqrt(std::abs(p[cells - 1] / at_valve)), p[cells - 1]);
    for (std::size_t i = 0; i < cells; ++i) {
      const double rate = (v[i] - v[i + 1]) / dx;
      e[i] += dt * rate;
      p[i] = std::max(vapour, steady[i] + water * wave_speed * wave_speed * e[i] + (rate > 0 ? 0.3 * water * wave_speed * dx * rate : 0.0));
    }
    valve = p[cells - 1];
    mean += valve;
    ++count;
    if (t + dt < next) continue;
    text += fmt::format("{:.4f},{:.1f}\n", next, 1e-3 * mean / double(count) + 4 * noise.normal());  // the recorder takes the mean of a millisecond
    next += sample;
    mean = 0;
    count = 0;
  }
  return text;
}

/// Six points of the trace, 2.06 MPa between 0.446 and 0.480 s and evenly spaced, are a line of the figure that it was taken from: left out.
std::string even_trace(const std::filesystem::path& path) {
  std::istringstream lines(read_text(path));
  std::vector<std::pair<double, double>> points;
  std::size_t left_out = 0;
  for (std::string line; std::getline(lines, line);) {
    double t = 0, p = 0;
    char comma = 0;
    if (std::istringstream s(line); !(s >> t >> comma >> p)) continue;
    if (t > 0.446 && t < 0.480 && p > 1000)
      ++left_out;
    else
      points.emplace_back(t, p);
  }
  if (points.size() < 2) throw InputError({.problem = "no points of time and pressure", .file = path.string()});
  std::sort(points.begin(), points.end());
  std::string text = "time,valve\n";
  std::size_t k = 0;
  for (double t = 0.0015; t < std::min(0.799, points.back().first); t += 0.001) {
    while (points[k + 1].first < t) ++k;
    const double w = (t - points[k].first) / (points[k + 1].first - points[k].first);
    text += fmt::format("{:.4f},{:.3f}\n", t, (1 - w) * points[k].second + w * points[k + 1].second);
  }
  fmt::print("{} points, {} of a line of the figure left out\n", points.size(), left_out);
  return text;
}

/// What a diagnosis found, and against the numbers of a file.
bool print_table(const std::filesystem::path& path, const char* expected) {
  const Json d = read_json(path);
  const Json &before = d.at("fit").at("before"), &ranking = d.at("ranking");
  const std::string unit = before.at("unit");
  std::map<std::string, double> found{{"residual of the base model", before.at("residual_rms")}, {"verdict " + d.at("verdict").get<std::string>(), 1}};
  fmt::print("verdict: {}: {}\n\n| explanation | log Bayes factor | probability | residual [{}] | by its numbers |\n|---|---|---|---|---|\n",
             d.at("verdict").get<std::string>(), d.at("reason").get<std::string>(), unit);
  std::vector<std::pair<double, std::string>> lead;
  for (const auto& r : ranking) {
    const std::string name = r.at("name");
    const bool model = r.contains("log_bayes_factor");
    std::string numbers;
    for (const auto& p : r.at("parameters")) {
      const std::string key = p.at("name");
      if (p.at("mean").is_null()) continue;
      numbers += fmt::format("{}{} {:.4g} ± {:.2g}", numbers.empty() ? "" : ", ", key, p.at("mean").get<double>(),
                             p.at("sd").is_null() ? 0.0 : p.at("sd").get<double>());
      found[key] = p.at("mean");
    }
    const Json& told_as = r.at(model ? "log_bayes_factor" : "log_evidence");
    const double factor = told_as.is_null() ? -1e300 : told_as.get<double>();
    if (r.contains("residual_rms")) found["residual of " + name] = r.at("residual_rms");
    if (model) lead.emplace_back(factor, name);
    fmt::print("| {} | {:.4g} | {:.2g} | {} | {} |\n", name, factor, r.at("probability").get<double>(),
               r.contains("residual_rms") ? fmt::format("{:.4g}", r.at("residual_rms").get<double>()) : "", numbers);
  }
  std::sort(lead.rbegin(), lead.rend());
  if (!lead.empty()) found["leader " + lead[0].second] = 1, found["log Bayes factor of the leader"] = lead[0].first;
  if (lead.size() > 1) found["lead over the next"] = lead[0].first - lead[1].first;
  fmt::print("\nbase model: residual {:.4g} {}, chi-squared {:.4g} for {:.0f} values\n", before.at("residual_rms").get<double>(), unit,
             d.at("evidence").at("chi2").get<double>(), d.at("evidence").at("values").get<double>());
  return expected == nullptr || examples::as_expected(found, expected);
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string verb = argc > 2 ? argv[1] : "";
  if (verb == "bar" && argc == 3) return write_atomically(argv[2], bar_record()), 0;
  if (verb == "pipe" && argc == 3) return write_atomically(argv[2], pipe_record()), 0;
  if (verb == "trace" && argc == 4) return write_atomically(argv[3], even_trace(argv[2])), 0;
  if (verb == "table") return print_table(argv[2], argc > 3 ? argv[3] : nullptr) ? 0 : 1;
  fmt::print(
      stderr,
      "line_records bar OUT.csv\nline_records pipe OUT.csv\nline_records trace TRACE.csv OUT.csv\nline_records table OUT/diagnosis.json [expected.csv]\n");
  return 2;
} catch (const std::exception& e) {
  fmt::print(stderr, "{}\n", e.what());
  return 2;
}
