#include "forward/solver/load.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/input_file.hpp"

namespace calomel {

double ProfileOptions::greatest() const {
  // g' = 0 at exp(-x/x1) = (1 + b) x1 / (b (decay + x1)); at x = 0 when there is no such x > 0.
  if (buildup <= 0) return 1;
  const double e = (1 + buildup) * buildup_length / (buildup * (decay + buildup_length));
  if (e >= 1) return 1;
  const double x = -buildup_length * std::log(e);
  return (1 + buildup * (1 - e)) * std::exp(-x / decay);
}

double ProfileOptions::shape(const Vec3& x, bool plane_strain) const {
  const double depth = x[0] - front, along = (1 + buildup * (1 - std::exp(-depth / buildup_length))) * std::exp(-depth / decay) / greatest();
  double across = 0.5 * std::pow(std::abs((x[2] - center[1]) / widths[1]), exponent);
  if (!plane_strain) across += 0.5 * std::pow(std::abs((x[1] - center[0]) / widths[0]), exponent);
  return along * std::exp(-across);
}

void LoadOptions::validate() const {
  if (kind == "end_stress") {
    if (file.empty()) throw InputError({.problem = "an end_stress needs the key \"file\" with the measured history", .key = "kind", .value = "\"end_stress\""});
    return;
  }
  if (peak_pressure && energy)
    throw InputError(
        {.problem = "peak_pressure and energy give the same quantity", .key = "energy", .value = number_text(*energy), .suggestion = "keep one of them"});
  if (!peak_pressure && !energy)
    throw InputError({.problem = "the strength of the pulse is missing",
                      .key = "kind",
                      .value = '"' + kind + '"',
                      .suggestion = "add peak_pressure = ... [Pa] or energy = ... [J]"});
}

const Registry<std::string>& loads() {
  static const Registry<std::string> all =
      Registry<std::string>("load")
          .add("initial_pressure", "the pulse heats the mercury: p0(x) grows linearly over the pulse length", "initial_pressure")
          .add("end_stress", "a measured stress history on the end face x = 0 of a bar", "end_stress");
  return all;
}

std::string policy_text(const LoadOptions& load) {
  if (load.kind == "end_stress") return "a measured stress acts on the end";
  return load.policy == "gruneisen" ? "the heating pressure is Gamma q and follows the sound speed (gruneisen)"
                                    : "the heating pressure is given and does not change with the parameters (fixed)";
}

double gruneisen(const MercuryOptions& m, double sound_speed) { return m.thermal_expansion * sound_speed * sound_speed / m.specific_heat; }

HeatingShape heating_shape(const Mesh& mesh, const ProfileOptions& profile) {
  HeatingShape out{std::vector<double>(mesh.elements.size(), 0.0), 0.0};
  const double gauss = 1 / std::sqrt(3.0);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    if (mesh.region[e] != Region::mercury) continue;
    double sum = 0, volume = 0;
    for (int point = 0; point < 8; ++point) {
      const double xi[3] = {point & 1 ? gauss : -gauss, point & 2 ? gauss : -gauss, point & 4 ? gauss : -gauss};
      Vec3 x{};
      double j[3][3] = {};
      for (int corner = 0; corner < 8; ++corner) {
        const auto& p = mesh.nodes[std::size_t(mesh.elements[e][std::size_t(corner)])];
        const double s[3] = {corner & 1 ? 1. : -1., corner & 2 ? 1. : -1., corner & 4 ? 1. : -1.};
        const double f[3] = {1 + s[0] * xi[0], 1 + s[1] * xi[1], 1 + s[2] * xi[2]};
        for (std::size_t c = 0; c < 3; ++c) {
          x[c] += 0.125 * f[0] * f[1] * f[2] * p[c];
          j[c][0] += 0.125 * s[0] * f[1] * f[2] * p[c];
          j[c][1] += 0.125 * s[1] * f[0] * f[2] * p[c];
          j[c][2] += 0.125 * s[2] * f[0] * f[1] * p[c];
        }
      }
      const double det = j[0][0] * (j[1][1] * j[2][2] - j[1][2] * j[2][1]) - j[0][1] * (j[1][0] * j[2][2] - j[1][2] * j[2][0]) +
                         j[0][2] * (j[1][0] * j[2][1] - j[1][1] * j[2][0]);
      sum += det * profile.shape(x, mesh.plane_strain);
      volume += det;
    }
    out.element[e] = sum / volume;
    out.integral += sum;
  }
  return out;
}

double History::at(double t) const {
  if (time.empty()) return 0;
  if (t <= time.front()) return value.front();
  if (t >= time.back()) return value.back();
  const auto i = std::size_t(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  const double w = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return (1 - w) * value[i - 1] + w * value[i];
}

History read_history(const std::filesystem::path& path) {
  std::ifstream in = input_file("load.file", path);
  History h;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string first;
    if (!(words >> first) || first[0] == '#') continue;
    double t = 0, s = 0;
    std::istringstream again(line);
    if (!(again >> t >> s)) {
      if (h.time.empty() && number == 1) continue;  // a header
      throw InputError({.problem = "two numbers are expected, time [s] and stress", .value = '"' + line + '"', .file = path.string(), .line = number});
    }
    if (!h.time.empty() && t <= h.time.back())
      throw InputError({.problem = "time must increase", .value = number_text(t), .file = path.string(), .line = number});
    h.time.push_back(t);
    h.value.push_back(s);
  }
  if (h.time.size() < 2) throw InputError({.problem = "holds fewer than two samples", .file = path.string()});
  return h;
}

}  // namespace calomel
