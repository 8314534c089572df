/// Records of a box slice with concealed physics: reference_generator SPEC.toml OUT_DIR [--truth FILE] [--mean FILE] [--threads N]
///
/// Writes case.toml and recordings.csv into OUT_DIR and, apart from it, the truth (OUT_DIR.truth.toml by default). --mean FILE writes the noise-free mean
/// record and nothing else.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>

#include "base/random.hpp"
#include "tests/proof/experiment.hpp"

namespace {

using namespace calomel::proof;
using calomel::RandomStream;

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::vector<Effect> scaled(const std::vector<Effect>& effects, double times) {
  std::vector<Effect> out;
  for (const auto& e : effects) out.push_back(e.scaled(times));
  return out;
}

/// Quantiles of the spread of energies.
std::vector<double> quantiles(const Experiment& x, int count) {
  std::vector<double> sorted = x.energies, out;
  std::sort(sorted.begin(), sorted.end());
  for (int i = 0; i < count; ++i) out.push_back(sorted[std::size_t((i + 0.5) / count * double(sorted.size()))]);
  return out;
}

/// The scale of the effects at which they make the target strength, by secants and halvings in logarithms on a coarser grid.
double find_scale(const Experiment& x, int threads) {
  const auto energies = quantiles(x, x.search_pulses);
  const auto pulses = energies.size();
  const auto base = mean_of(x.strains({}, x.search_grid, energies, threads), pulses);
  const auto made = [&](double scale) {
    const double s =
        strength(difference(mean_of(x.strains(scaled(x.effects, scale), x.search_grid, energies, threads), pulses), base, x.gauges.size(), x.interval).band, x);
    fmt::print("scale {:.4g}: strength {:.4f} on {} mm\n", scale, s, 1e3 * x.search_grid);
    std::fflush(stdout);
    return s;
  };
  double scale = 1, best = 1, best_off = 1e300, scale_before = 0, made_before = 0, below = x.least_scale, above = x.greatest_scale;
  for (int trial = 0; trial < 8; ++trial) {
    const double s = std::max(made(scale), 1e-6), off = std::log(s / x.target_strength);
    if (std::abs(off) < best_off) best_off = std::abs(off), best = scale;
    if (std::abs(off) < 0.08) break;
    (off < 0 ? below : above) = scale;
    double slope = 1;
    if (scale_before > 0 && scale != scale_before) slope = std::clamp(std::log(s / made_before) / std::log(scale / scale_before), 0.4, 3.0);
    scale_before = scale;
    made_before = s;
    scale = scale * std::exp(std::clamp(-off / slope, -2.5, 2.5));
    if (scale <= below || scale >= above) {  // halve what is left; the ends themselves while nothing has been seen beyond
      const bool open = scale <= below ? below == x.least_scale : above == x.greatest_scale;
      scale = open ? std::clamp(scale, below, above) : std::sqrt(below * above);
    }
    if (scale == scale_before) break;
  }
  return best;
}

std::string truth_text(const Experiment& x, const std::vector<Effect>& effects, double scale, const Difference& d, double seconds) {
  std::set<std::string> library;
  bool outside = false, sensor = true;
  for (const auto& e : effects) {
    outside = outside || library_name(e.name).empty();
    sensor = sensor && e.name == "gauge_fault";
    if (!library_name(e.name).empty()) library.insert(library_name(e.name));
  }
  const char* family = effects.empty() ? "none" : sensor ? "sensor" : outside ? "outside" : library.size() > 1 ? "pair" : "single";
  std::string label;
  for (const auto& name : library) label += (label.empty() ? "" : "+") + name;
  std::string t = fmt::format(
      "name = \"{}\"\nseed = {}\nfamily = \"{}\"  # none, single, pair, outside, sensor\nmechanism = \"{}\"  # the library's name; empty: none, or it has no "
      "such mechanism\n",
      x.name, x.seed, family,
      effects.empty() ? "none"
      : outside       ? ""
                      : label);
  t += fmt::format("grid = {}\nseconds = {:.1f}\n\n", x.grid, seconds);
  t += fmt::format(
      "[strength]  # relative L2 between the mean records with and without the effects\ndecimated = {:.5f}  # by a Hann window to 20 kHz, mean over gauges (of "
      "a gauge's fault: that gauge)\n"
      "samples = {:.5f}\nscale = {:.5g}\ntarget = {:.5g}\nby_gauge = [{:.5f}]\n\n",
      effects.empty() ? 0.0 : strength(d.band, x), effects.empty() ? 0.0 : strength(d.raw, x), scale, x.target_strength, fmt::join(d.band, ", "));
  t += fmt::format("[parameter]\ndensity = {:.10g}\nsound_speed = {:.10g}\ntensile_cutoff = {:.10g}\n\n", x.density, x.sound_speed, x.cutoff);
  t += fmt::format(
      "[nuisance]\nyoung = {:.10g}\nviscosity = {:.10g}\npulse_length = {:.6g}\nenergy = {:.10g}\nenergies = [{:.6f}]\nnoise_time = "
      "{:.3g}\nwall_strength_ratio = {:.3g}\n\n",
      x.young, x.viscosity, x.pulse_length, x.energy, fmt::join(x.energies, ", "), x.noise_time, x.wall_strength_ratio);
  for (const auto& g : x.gauges) t += fmt::format("[nuisance.gauge.{}]\nmoved = {:.6g}\ngain = {:.6f}\nnoise = {:.4g}\n\n", g.name, g.moved, g.gain, g.noise);
  for (const auto& e : effects) {
    t += fmt::format("[[effect]]\nname = \"{}\"\nmechanism = \"{}\"\n", e.name, library_name(e.name));
    for (const auto& [key, value] : e.word) t += fmt::format("{} = \"{}\"\n", key, value);
    for (const auto& [key, value] : e.number) t += fmt::format("{} = {:.10g}\n", key, value);
    // What the library's own keys would be, where there is an equivalent.
    std::string same;
    if (e.name == "beam") {
      if (e.number.contains("offset_z")) same += fmt::format("offset_z = {:.8g}\n", e["offset_z"]);
      if (e.number.contains("width_ratio")) same += fmt::format("width_ratio_z = {:.8g}\n", e["width_ratio"]);
      if (e.number.contains("energy_ratio")) same += fmt::format("energy_ratio = {:.8g}\n", e["energy_ratio"]);
      if (e.number.contains("pulse_length_ratio")) same += fmt::format("pulse_length = {:.8g}\n", x.pulse_length * e["pulse_length_ratio"]);
    }
    if (e.name == "rear_layer") same += fmt::format("coefficient = {:.8g}\n", (e["impedance_ratio"] - 1) / (e["impedance_ratio"] + 1));
    if (e.name == "relaxing_liquid") same += fmt::format("zeta = {:.8g}\n", e["viscosity"]);
    if (e.name == "tait") same += fmt::format("exponent = {:.8g}\n", e["stiffening"] + 1);
    if (e.name == "bubbles") same += fmt::format("alpha0 = {:.8g}\n", e["small_fraction"] + e["large_fraction"]);
    if (e.name == "nucleation") same += fmt::format("nuclei_spacing = {:.8g}\n", std::cbrt(1 / e["number"]));
    if (e.name == "heated_steel") same += fmt::format("delta_t = {:.8g}\n", e["rise"]);
    if (e.name == "debonding") same += fmt::format("strength = {:.8g}\nbegin = {:.8g}\nend = {:.8g}\n", e["strength"], e["begin"], e["begin"] + e["length"]);
    if (e.name == "thinning")  // where it would end if it were as deep everywhere and as much steel were gone
      same +=
          fmt::format("fraction = {:.8g}\nbegin = {:.8g}\nend = {:.8g}\n", e["fraction"], e["begin"] + e["length"] / 16, e["begin"] + e["length"] * 15 / 16);
    if (e.name == "gauge_fault")
      for (const auto& [key, value] : e.number) same += fmt::format("{} = {:.8g}\n", key, value);
    if (!same.empty()) t += "[effect.library]\n" + same;
    t += '\n';
  }
  return t;
}

/// Ornstein and Uhlenbeck's noise, sampled exactly.
void add_noise(double* y, std::size_t n, double sd, double interval, double time, RandomStream& random) {
  const double keep = time > 0 ? std::exp(-interval / time) : 0, new_sd = sd * std::sqrt(1 - keep * keep);
  double e = sd * random.normal();
  for (std::size_t k = 0; k < n; ++k) {
    y[k] += e;
    e = keep * e + new_sd * random.normal();
  }
}

void generate(const std::filesystem::path& spec, const std::filesystem::path& out, std::filesystem::path truth, const std::filesystem::path& mean_file,
              int threads) {
  Experiment x = Experiment::read(spec);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  double scale = 1;
  if (!x.effects.empty() && x.target_strength > 0) scale = find_scale(x, threads);
  const auto effects = scaled(x.effects, scale);
  const auto pulses = x.energies.size(), gauges = x.gauges.size(), n = x.samples();
  const auto strains = x.strains(effects, x.grid, x.energies, threads);
  const double recorded = elapsed();
  if (!mean_file.empty()) {
    const auto m = mean_of(strains, pulses);
    std::string text = "sensor,time,strain\n";
    for (std::size_t g = 0; g < gauges; ++g)
      for (std::size_t k = 0; k < n; ++k) text += fmt::format("{},{:.6e},{:.7e}\n", x.gauges[g].name, double(k) * x.interval, m[g * n + k]);
    write(mean_file, text);
    fmt::print("{} pulses on {} mm in {:.1f} s\n", pulses, 1e3 * x.grid, recorded);
    return;
  }
  Difference d;
  if (!effects.empty()) {
    d = difference(mean_of(strains, pulses), mean_of(x.strains({}, x.grid, x.energies, threads), pulses), gauges, x.interval);
    fmt::print("strength {:.4f} decimated, {:.4f} of all samples (target {:.4f})\n", strength(d.band, x), strength(d.raw, x), x.target_strength);
  }
  std::filesystem::create_directories(out);
  write(out / "case.toml", x.case_file());
  std::string text = "sensor,pulse,time,strain\n";
  for (std::size_t g = 0; g < gauges; ++g)
    for (std::size_t p = 0; p < pulses; ++p) {
      std::vector<double> y(strains.begin() + std::ptrdiff_t((p * gauges + g) * n), strains.begin() + std::ptrdiff_t((p * gauges + g + 1) * n));
      RandomStream random(x.seed, 1000 + g * pulses + p);
      add_noise(y.data(), n, x.gauges[g].noise, x.interval, x.noise_time, random);
      for (std::size_t k = 0; k < n; ++k) text += fmt::format("{},{},{:.6e},{:.6e}\n", x.gauges[g].name, p, double(k) * x.interval, y[k]);
    }
  write(out / "recordings.csv", text);
  if (truth.empty()) truth = out.string() + ".truth.toml";
  write(truth, truth_text(x, effects, scale, d, elapsed()));
  fmt::print("{}: {} pulses on {} mm in {:.1f} s, all in {:.1f} s\n", x.name, pulses, 1e3 * x.grid, recorded, elapsed());
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<std::filesystem::path> places;
  std::filesystem::path truth, mean_file;
  int threads = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.starts_with("--") && i + 1 < argc) {
      if (word == "--truth")
        truth = argv[++i];
      else if (word == "--mean")
        mean_file = argv[++i];
      else if (word == "--threads")
        threads = std::stoi(argv[++i]);
      else
        throw std::runtime_error("no option " + word);
    } else {
      places.emplace_back(word);
    }
  }
  if (places.size() != (mean_file.empty() ? 2 : 1)) {
    fmt::print(stderr,
               "usage: reference_generator SPEC.toml OUT_DIR [--truth FILE] [--threads N]\n       reference_generator SPEC.toml --mean FILE [--threads N]\n");
    return 2;
  }
  generate(places[0], places.size() > 1 ? places[1] : "", truth, mean_file, threads);
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "reference_generator: {}\n", e.what());
  return 2;
}
