#include "tests/proof/experiment.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "base/random.hpp"

namespace calomel::proof {

namespace {

/// How a number of an effect follows its strength.
enum class Follows { not_at_all, proportion, logarithm, inverse, inverse_square };

struct Known {
  const char* library;  ///< name of the library's mechanism, or ""
  std::map<std::string, Follows> keys;
};

const std::map<std::string, Known>& known_effects() {
  using enum Follows;
  static const std::map<std::string, Known> known = {
      {"beam", {"beam_profile", {{"offset_z", proportion}, {"width_ratio", logarithm}, {"energy_ratio", logarithm}, {"pulse_length_ratio", logarithm}}}},
      {"rear_layer", {"rear_reflection", {{"impedance_ratio", logarithm}, {"depth", not_at_all}}}},
      {"bubbles",
       {"bubbly_liquid",
        {{"small_fraction", proportion},
         {"large_fraction", proportion},
         {"small_radius", not_at_all},
         {"large_radius", not_at_all},
         {"ambient", not_at_all},
         {"viscosity", not_at_all}}}},
      {"nucleation", {"cavitation_kinetics", {{"number", inverse_square}, {"radius", not_at_all}, {"stronger", not_at_all}, {"strength", not_at_all}}}},
      {"relaxing_liquid", {"liquid_viscosity", {{"viscosity", proportion}, {"time", not_at_all}}}},
      {"zener_steel", {"structural_damping", {{"loss", proportion}, {"frequency", not_at_all}}}},
      {"heated_steel", {"thermal_stress", {{"rise", proportion}, {"depth", not_at_all}, {"expansion", not_at_all}}}},
      {"tait", {"nonlinear_eos", {{"stiffening", proportion}}}},
      {"debonding", {"interface", {{"begin", not_at_all}, {"length", proportion}, {"strength", not_at_all}}}},
      {"thinning", {"wall_thinning", {{"begin", not_at_all}, {"length", not_at_all}, {"fraction", proportion}}}},
      {"residual_ringing", {"previous_pulses", {{"amplitude", proportion}, {"after", not_at_all}}}},
      {"gauge_fault", {"sensor_response", {{"gain", logarithm}, {"delay", proportion}, {"low_pass", inverse}, {"angle", proportion}}}},
      {"yielding", {"", {{"stress", inverse}, {"hardening", not_at_all}}}},
      {"rib", {"", {{"place", not_at_all}, {"thickness", not_at_all}, {"height", proportion}}}},
      {"gas_pocket", {"", {{"begin", not_at_all}, {"length", proportion}, {"thickness", not_at_all}}}},
      {"speed_gradient", {"", {{"change", proportion}}}},
      {"added_mass", {"", {{"begin", not_at_all}, {"length", not_at_all}, {"mass", proportion}}}},
      {"slot", {"", {{"place", not_at_all}, {"width", not_at_all}, {"depth", proportion}}}},
  };
  return known;
}

const Known& known(const std::string& effect) {
  const auto found = known_effects().find(effect);
  if (found == known_effects().end()) throw std::runtime_error("no effect is called " + effect);
  return found->second;
}

/// Reads a table's numbers into variables and complains about keys that nobody has requested.
class Table {
 public:
  Table(const toml::table* table, std::string name) : table_(table), name_(std::move(name)) {}
  template <class Number>
  Table& operator()(const char* key, Number& value) {
    asked_.emplace_back(key);
    if (const auto* node = table_ ? table_->get(key) : nullptr) {
      if constexpr (std::is_same_v<Number, std::string>)
        value = node->value<std::string>().value();
      else if constexpr (std::is_integral_v<Number>)
        value = Number(node->value<std::int64_t>().value());
      else
        value = node->value<double>().value();
    }
    return *this;
  }
  Table& knows(const char* key) {
    asked_.emplace_back(key);
    return *this;
  }
  ~Table() noexcept(false) {
    if (!table_ || std::uncaught_exceptions() > 0) return;
    for (const auto& [key, node] : *table_)
      if (!node.is_array_of_tables() && std::find(asked_.begin(), asked_.end(), std::string(key.str())) == asked_.end())
        throw std::runtime_error("no key " + std::string(key.str()) + " in " + name_);
  }

 private:
  const toml::table* table_;
  std::string name_;
  std::vector<std::string> asked_;
};

/// What a channel makes of a strain, (time).
void read_channel(std::vector<double>& y, double interval, const Effect& fault) {
  const auto number = [&](const char* key, double off) { return fault.number.contains(key) ? fault[key] : off; };
  const double low_pass = number("low_pass", 0), delay = number("delay", 0), angle = number("angle", 0) * std::numbers::pi / 180;
  if (low_pass > 0) {  // three equal first-order lags, 3 dB down at low_pass
    const double lag = std::sqrt(std::cbrt(2.0) - 1) / (2 * std::numbers::pi * low_pass), keep = std::exp(-interval / lag);
    for (int stage = 0; stage < 3; ++stage) {
      double held = 0, before = 0;
      for (double& v : y) {  // exact for an input that is linear between samples
        const double slope = (v - before) / interval;
        held = v - slope * lag + (held - before + slope * lag) * keep;
        before = v;
        v = held;
      }
    }
  }
  if (delay != 0) {
    const std::vector<double> x = y;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const double place = double(k) - delay / interval;
      const double bounded = std::clamp(place, 0.0, double(x.size() - 1));
      const auto i = std::min(std::size_t(bounded), x.size() - 2);
      y[k] = x[i] + (bounded - double(i)) * (x[i + 1] - x[i]);
    }
  }
  const double turned = std::cos(angle) * std::cos(angle);  // in plane strain there is none across
  for (double& v : y) v *= number("gain", 1) * turned;
}

}  // namespace

double Effect::operator[](const std::string& key) const {
  const auto found = number.find(key);
  if (found == number.end()) throw std::runtime_error("the effect " + name + " needs " + key);
  return found->second;
}

Effect Effect::scaled(double times) const {
  Effect e = *this;
  for (auto& [key, value] : e.number) switch (known(name).keys.at(key)) {
      case Follows::not_at_all:
        break;
      case Follows::proportion:
        value *= times;
        break;
      case Follows::logarithm:
        value = std::exp(times * std::log(value));
        break;
      case Follows::inverse:
        value /= times;
        break;
      case Follows::inverse_square:
        value /= times * times;
        break;
    }
  return e;
}

std::string library_name(const std::string& effect) { return known(effect).library; }

Experiment Experiment::read(const std::filesystem::path& path) {
  const toml::table file = toml::parse_file(path.string());
  Experiment e;
  const auto table = [&](const char* name) { return Table(file[name].as_table(), "[" + std::string(name) + "] of " + path.string()); };
  for (const auto& [key, node] : file)
    if (static const std::vector<std::string> names = {"case", "geometry", "steel", "mercury", "nominal", "load", "time", "pulses", "gauges", "gauge", "effect",
                                                       "strength"};
        std::find(names.begin(), names.end(), std::string(key.str())) == names.end())
      throw std::runtime_error("no table [" + std::string(key.str()) + "] is known in " + path.string());
  table("case")("name", e.name)("seed", e.seed)("grid", e.grid);
  table("geometry")("length", e.length)("height", e.height)("front", e.front)("top", e.top)("bottom", e.bottom)("rear", e.rear);
  table("steel")("density", e.steel_density)("young", e.young)("poisson", e.poisson);
  table("mercury")("density", e.density)("sound_speed", e.sound_speed)("tensile_cutoff", e.cutoff)("viscosity", e.viscosity)("collapse", e.collapse)(
      "wall_strength_ratio", e.wall_strength_ratio);
  table("nominal")("young", e.nominal_young)("density", e.nominal_density)("sound_speed", e.nominal_sound_speed)("tensile_cutoff", e.nominal_cutoff)(
      "pulse_length", e.nominal_pulse_length);
  e.center = e.height / 2;
  table("load")("peak_pressure", e.peak)("center", e.center)("width", e.width)("decay", e.decay)("buildup", e.buildup)("buildup_length", e.buildup_length)(
      "exponent", e.exponent)("pulse_length", e.pulse_length);
  table("time")("end", e.end)("interval", e.interval);
  table("pulses")("count", e.pulses)("energy", e.energy)("energy_sd", e.energy_sd).knows("energies");
  if (const auto* list = file["pulses"]["energies"].as_array())
    for (const auto& v : *list) e.energies.push_back(v.value<double>().value());
  table("gauges")("place_sd", e.place_sd)("gain_sd", e.gain_sd)("noise_time", e.noise_time);
  table("strength")("target", e.target_strength)("least_scale", e.least_scale)("greatest_scale", e.greatest_scale)("grid", e.search_grid)("pulses",
                                                                                                                                          e.search_pulses);
  if (const auto* list = file["gauge"].as_array())
    for (const auto& node : *list) {
      GaugeSpec g;
      std::string direction = "x";
      Table(node.as_table(), "[[gauge]]")("name", g.name)("x", g.x)("z", g.z)("direction", direction)("length", g.length)("noise", g.noise);
      g.along_x = direction == "x";
      e.gauges.push_back(g);
    }
  if (const auto* list = file["effect"].as_array())
    for (const auto& node : *list) {
      Effect effect;
      for (const auto& [key, value] : *node.as_table()) {
        const std::string k(key.str());
        if (k == "name")
          effect.name = value.value<std::string>().value();
        else if (value.is_string())
          effect.word[k] = value.value<std::string>().value();
        else
          effect.number[k] = value.value<double>().value();
      }
      for (const auto& [key, value] : effect.number)
        if (!known(effect.name).keys.contains(key)) throw std::runtime_error("the effect " + effect.name + " has no key " + key);
      e.effects.push_back(effect);
    }
  e.draw();
  return e;
}

void Experiment::draw() {
  RandomStream pulse(seed, 1), channel(seed, 2);
  if (energies.empty())
    for (int i = 0; i < pulses; ++i) energies.push_back(energy * (1 + energy_sd * pulse.normal()));
  pulses = int(energies.size());
  for (auto& g : gauges) {
    g.moved = place_sd * channel.normal();
    g.gain = 1 + gain_sd * channel.normal();
  }
}

std::size_t Experiment::samples() const { return std::size_t(std::lround(end / interval)) + 1; }

Slice Experiment::slice(const std::vector<Effect>& concealed, double h) const {
  const auto find = [&](const char* wanted) -> const Effect* {
    for (const auto& e : concealed)
      if (e.name == wanted) return &e;
    return nullptr;
  };
  // 1. The cells.
  const Effect *rib = find("rib"), *thinning = find("thinning"), *slot = find("slot");
  const int margin = 1 + (rib ? int(std::lround((*rib)["height"] / h)) : 0);
  const int nx = int(std::lround(length / h)), nz = int(std::lround(height / h));
  Grid g(nx + 2 * margin, nz + 2 * margin, h, -margin * h, -margin * h);
  const double low = bottom, high = height - top;
  g.fill(Cell::solid, 0, length, 0, height);
  g.fill(Cell::mercury, front, length - rear, low, high);
  if (rear == 0) g.fill(Cell::continuing, length, length + h, low, high);
  const auto at_wall = [&](const Effect& e, const char* wall) { return e.word.contains("wall") ? e.word.at("wall") == wall : std::string(wall) == "top"; };
  // A depth that is no whole number of cells leaves a cell of less density and stiffness.
  struct Part {
    double x0, x1, z0, z1, left;
  };
  std::vector<Part> parts;
  const auto carve = [&](Cell into, const std::string& wall, bool from_inside, double begin, double end_, double deep) {
    double whole = std::floor(deep / h + 1e-9), part = deep / h - whole;
    if (part > 0.85) whole += 1, part = 0;
    const bool front_wall = wall == "front", top_wall = wall == "top";
    const double outer = top_wall ? height : 0, inner = front_wall ? front : top_wall ? high : low;
    const double start = from_inside ? inner : outer, direction = (inner > outer) == from_inside ? -1 : 1;
    const auto box = [&](double from, double to) {
      const double u = start + direction * from, v = start + direction * to;
      const double least = std::min(u, v), most = std::max(u, v);
      return front_wall ? std::array{least, most, begin, end_} : std::array{begin, end_, least, most};
    };
    const auto b = box(0, whole * h), p = box(whole * h, (whole + 1) * h);
    g.fill(into, b[0], b[1], b[2], b[3]);
    if (part > 1e-6) parts.push_back({p[0], p[1], p[2], p[3], 1 - part});
  };
  const auto thickness = [&](const Effect& e) { return at_wall(e, "front") ? front : at_wall(e, "top") ? top : bottom; };
  const auto wall_of = [](const Effect& e) { return e.word.contains("wall") ? e.word.at("wall") : std::string("top"); };
  if (thinning) {  // eaten away from inside, half as deep over the first and last eighth
    const Effect& e = *thinning;
    const double b = e["begin"], l = e["length"], deep = std::min(e["fraction"], 0.8) * thickness(e);
    carve(Cell::mercury, wall_of(e), true, b, b + l, 0.5 * deep);
    carve(Cell::mercury, wall_of(e), true, b + 0.125 * l, b + 0.875 * l, deep);
  }
  if (slot) {  // cut from outside
    const Effect& e = *slot;
    const double p = h * std::round(e["place"] / h), w = h * std::max(1.0, std::round(e["width"] / h));
    carve(Cell::vacuum, wall_of(e), false, p, p + w, std::min(e["depth"], 0.9 * thickness(e)));
  }
  if (rib) {
    const Effect& e = *rib;
    const double p = h * std::round(e["place"] / h), t = h * std::round(e["thickness"] / h);
    if (at_wall(e, "top")) g.fill(Cell::solid, p, p + t, height, height + e["height"]);
    if (at_wall(e, "bottom")) g.fill(Cell::solid, p, p + t, -e["height"], 0);
  }

  // 2. The materials.
  Mercury mercury{.density = density, .sound_speed = sound_speed, .cutoff = cutoff, .viscosity = viscosity, .collapse = collapse};
  if (const Effect* e = find("speed_gradient")) mercury.speed_gradient = (*e)["change"] / (high - low), mercury.gradient_middle = 0.5 * (low + high);
  const Solid steel = Solid::from_young(steel_density, young, poisson);
  Slice s(g, steel, mercury);
  for (const Part& part : parts)
    s.set_solid([&](double x, double z) { return x > part.x0 && x < part.x1 && z > part.z0 && z < part.z1; },
                {part.left * steel.density, part.left * steel.lambda, part.left * steel.mu});
  if (const Effect* e = find("rear_layer"))
    s.behind = {.coefficient = ((*e)["impedance_ratio"] - 1) / ((*e)["impedance_ratio"] + 1), .delay = 2 * (*e)["depth"] / sound_speed};
  if (const Effect* e = find("added_mass")) s.add_mass((*e)["begin"], (*e)["begin"] + (*e)["length"], at_wall(*e, "top") ? height : 0, (*e)["mass"]);
  if (const Effect* e = find("nucleation"))
    s.nucleation = {.number = (*e)["number"], .radius = (*e)["radius"], .stronger = (*e)["stronger"], .strength = (*e)["strength"]};
  if (const Effect* e = find("relaxing_liquid")) s.relaxing = {(*e)["viscosity"], (*e)["time"]};
  if (const Effect* e = find("tait")) s.tait.exponent = (*e)["stiffening"] - 1;
  if (const Effect* e = find("bubbles"))
    s.bubbles = {.fraction = {(*e)["small_fraction"], (*e)["large_fraction"]},
                 .radius = {(*e)["small_radius"], (*e)["large_radius"]},
                 .ambient = (*e)["ambient"],
                 .viscosity = (*e)["viscosity"]};
  if (const Effect* e = find("zener_steel")) s.zener = {.strength = 4 * (*e)["loss"], .time = 1 / (2 * std::numbers::pi * (*e)["frequency"])};
  if (const Effect* e = find("yielding")) s.yielding = {(*e)["stress"], (*e)["hardening"]};

  // 3. The faces.
  if (wall_strength_ratio != 1) s.set_contacts([&](Contact& c, double, double) { c.strength *= wall_strength_ratio; });
  const Effect *debonding = find("debonding"), *pocket = find("gas_pocket");
  if (debonding || pocket)
    s.set_contacts([&](Contact& c, double x, double z) {
      const auto covers = [&](const Effect& e) {
        const bool wall = (at_wall(e, "top") && c.across_z && c.sign > 0) || (at_wall(e, "bottom") && c.across_z && c.sign < 0) ||
                          (at_wall(e, "front") && !c.across_z && c.sign < 0);
        const double along = c.across_z ? x : z;
        return wall && along > e["begin"] && along < e["begin"] + e["length"];
      };
      if (debonding && covers(*debonding)) c.strength = (*debonding)["strength"], c.suction = 0, c.brittle = true;
      if (pocket && covers(*pocket)) c.gas_gap = (*pocket)["thickness"];
    });

  // 4. The load.
  double z0 = center, wz = width, p_peak = peak;
  s.pulse_length = pulse_length;
  if (const Effect* e = find("beam")) {
    const auto number = [&](const char* key, double off) { return e->number.contains(key) ? (*e)[key] : off; };
    z0 += number("offset_z", 0);
    wz *= number("width_ratio", 1);
    p_peak *= number("energy_ratio", 1);
    s.pulse_length *= number("pulse_length_ratio", 1);
  }
  const auto along = [this](double x) { return (1 + buildup * (1 - std::exp(-x / buildup_length))) * std::exp(-x / decay); };
  double greatest = 0;
  for (int k = 0; k <= 10000; ++k) greatest = std::max(greatest, along(5 * buildup_length * k / 10000));
  const auto profile = [&](double x, double z) { return p_peak * along(x) / greatest * std::exp(-0.5 * std::pow(std::abs((z - z0) / wz), exponent)); };
  s.set_pressure(profile);
  if (const Effect* heated = find("heated_steel"))
    s.set_heated_solid([&](double x, double z) {
      const double u = x / (*heated)["depth"];
      return (3 * steel.lambda + 2 * steel.mu) * (*heated)["expansion"] * (*heated)["rise"] * std::exp(-0.5 * std::pow(std::abs((z - z0) / wz), exponent)) /
             (1 + u * u);
    });
  return s;
}

std::vector<double> Experiment::strains(const std::vector<Effect>& concealed, double h, const std::vector<double>& at, int threads) const {
  const Slice s = slice(concealed, h);
  std::vector<Gauge> rows;
  for (const auto& g : gauges) rows.push_back(s.gauge(g.x + (g.along_x ? g.moved : 0), g.z + (g.along_x ? 0 : g.moved), g.along_x, g.length));
  // The state that the pulse before has left: a weak pulse, so that nothing gives way, of which a multiple is taken. As in life the steel loses while it rings,
  // so that high tones die first.
  State left;
  double left_scale = 0;
  for (const auto& e : concealed)
    if (e.name == "residual_ringing") {
      Experiment before = *this;
      before.cutoff = 1e15;
      left_scale = e["amplitude"];
      const Effect losses{.name = "zener_steel", .number = {{"loss", 0.01}, {"frequency", 2e4}}, .word = {}};
      (void)before.slice({losses}, h).run(1, e["after"], e["after"], {}, nullptr, 0, &left);
    }
  const std::size_t gauge_count = gauges.size(), n = samples();
  std::vector<double> out(at.size() * gauge_count * n);
  std::atomic<std::size_t> next{0};
  std::mutex guard;
  std::string failed;
  const auto work = [&] {
    try {
      for (std::size_t p = next++; p < at.size(); p = next++) {
        const auto strain = s.run(at[p], end, interval, rows, left_scale != 0 ? &left : nullptr, left_scale);
        std::copy(strain.begin(), strain.end(), out.begin() + std::ptrdiff_t(p * gauge_count * n));
      }
    } catch (const std::exception& e) {
      const std::lock_guard lock(guard);
      failed = e.what();
    }
  };
  std::vector<std::thread> pool;
  for (int t = 1; t < threads; ++t) pool.emplace_back(work);
  work();
  for (auto& t : pool) t.join();
  if (!failed.empty()) throw std::runtime_error(failed);

  for (std::size_t p = 0; p < at.size(); ++p)
    for (std::size_t g = 0; g < gauge_count; ++g) {
      const auto begin = out.begin() + std::ptrdiff_t((p * gauge_count + g) * n);
      std::vector<double> y(begin, begin + std::ptrdiff_t(n));
      for (double& v : y) v *= gauges[g].gain;
      for (const auto& e : concealed)
        if (e.name == "gauge_fault" && e.word.at("gauge") == gauges[g].name) read_channel(y, interval, e);
      std::copy(y.begin(), y.end(), begin);
    }
  return out;
}

std::vector<double> mean_of(const std::vector<double>& strains, std::size_t pulses) {
  const std::size_t n = strains.size() / pulses;
  std::vector<double> mean(n, 0);
  for (std::size_t p = 0; p < pulses; ++p)
    for (std::size_t k = 0; k < n; ++k) mean[k] += strains[p * n + k] / double(pulses);
  return mean;
}

Difference difference(const std::vector<double>& mean, const std::vector<double>& reference, std::size_t gauges, double interval) {
  const std::size_t n = mean.size() / gauges;
  const int factor = std::max(1, int(std::lround(25e-6 / interval)));
  std::vector<double> window;
  for (int k = 1 - factor; k < factor; ++k) window.push_back(std::pow(std::cos(std::numbers::pi * k / (2 * factor)), 2));
  Difference d;
  for (std::size_t g = 0; g < gauges; ++g) {
    const double *a = &mean[g * n], *b = &reference[g * n];
    double off = 0, size = 0;
    for (std::size_t k = 0; k < n; ++k) off += (a[k] - b[k]) * (a[k] - b[k]), size += b[k] * b[k];
    d.raw.push_back(std::sqrt(off / size));
    off = size = 0;
    for (std::size_t k = std::size_t(factor); k + std::size_t(factor) <= n; k += std::size_t(factor)) {
      double u = 0, v = 0;
      for (std::size_t w = 0; w < window.size(); ++w) u += window[w] * a[k + w + 1 - std::size_t(factor)], v += window[w] * b[k + w + 1 - std::size_t(factor)];
      off += (u - v) * (u - v);
      size += v * v;
    }
    d.band.push_back(std::sqrt(off / size));
  }
  return d;
}

double strength(const std::vector<double>& by_gauge, const Experiment& experiment) {
  std::string only;
  bool one = !experiment.effects.empty();
  for (const auto& e : experiment.effects) {
    const auto found = e.word.find("gauge");
    one = one && found != e.word.end() && (only.empty() || only == found->second);
    if (found != e.word.end()) only = found->second;
  }
  double sum = 0, count = 0;
  for (std::size_t g = 0; g < by_gauge.size(); ++g)
    if (!one || experiment.gauges[g].name == only) sum += by_gauge[g], ++count;
  return sum / count;
}

std::string Experiment::case_file() const {
  std::string t = fmt::format(
      "[case]\nname = \"{}\"\n\n[geometry]\nkind = \"box\"\nlength = {}\nwidth = 0.10\nheight = {}\nwalls = {{front = {}, rear = {}, side = 0.005, top = {}, "
      "bottom = {}}}\nrear = \"{}\"\n"
      "plane_strain = true\nelement_size = 0.002\n\n",
      name, length, height, front, rear > 0 ? rear : 0.005, top, bottom, rear > 0 ? "wall" : "non_reflecting");
  t += fmt::format("[material.steel]\ndensity = {:.1f}\nyoung = {:.5g}\npoisson = {}\n\n", steel_density, nominal_young, poisson);
  t += fmt::format("[material.mercury]\nlaw = \"riemer\"\ndensity = {:.1f}\nsound_speed = {:.1f}\ntensile_cutoff = {:.6g}\n\n", nominal_density,
                   nominal_sound_speed, nominal_cutoff);
  t += fmt::format("[load]\npolicy = \"fixed\"\npeak_pressure = {:.6g}\npulse_length = {:.4g}\n\n", peak, nominal_pulse_length);
  t += fmt::format("[load.profile]\ncenter = [0.0, {}]\nwidths = [1000.0, {}]\ndecay = {}\nbuildup = {}\nbuildup_length = {}\nexponent = {:.1f}\n\n", center,
                   width, decay, buildup, buildup_length, exponent);
  t += fmt::format("[time]\nend = {:.6g}\noutput_interval = {:.6g}\n\n", end, interval);
  for (const auto& g : gauges)
    t += fmt::format("[[sensor]]\nname = \"{}\"\nposition = [{}, 0.0, {}]\ndirection = {}\ngauge_length = {}\n\n", g.name, g.x, g.z,
                     g.along_x ? "[1, 0, 0]" : "[0, 0, 1]", g.length);
  t += "[recordings]\nfile = \"recordings.csv\"\n\n";
  t += fmt::format("[parameter.tensile_cutoff]\nmin = 0.0\nmax = 1500000.0\nprior = \"uniform\"\nnominal = {:.6g}\n\n", nominal_cutoff);
  t += fmt::format("[parameter.density]\nmin = 1350.0\nmax = 13600.0\nprior = \"uniform\"\nnominal = {:.1f}\n\n", nominal_density);
  t += fmt::format("[parameter.sound_speed]\nmin = 500.0\nmax = 4000.0\nprior = \"uniform\"\nnominal = {:.1f}\n", nominal_sound_speed);
  for (const char* m : {"bubbly_liquid", "cavitation_kinetics", "liquid_viscosity", "structural_damping", "nonlinear_eos", "thermal_stress", "beam_profile",
                        "previous_pulses", "rear_reflection", "interface", "sensor_response", "wall_thinning", "static_pressure"})
    t += fmt::format("\n[mechanism.{}]\n", m);
  return t;
}

}  // namespace calomel::proof
