#include "apps/inputs/posterior_case.hpp"

#include <algorithm>
#include <cmath>

#include "forward/level_runs.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr double box_of_viscosity = 1.8;                ///< half width of the box in its logarithm, in prior sds
constexpr double widest_viscosity = 3;                  ///< bounds of its prior, in sds
constexpr double box_of_young = 2.5, widest_young = 5;  ///< the same of the steel's modulus
constexpr double box_of_film = 2.5, widest_film = 3;    ///< the same of the walls' film
constexpr double mesh_error_by_size = 80;               ///< over the local amplitude, per metre of element size: of the first order
constexpr double box_of_prior = 2;                      ///< half width of a line's first box, in prior sds
constexpr double resolving = 1.25;                      ///< lengths of the pulse's front that an element may have which resolves it
constexpr double same_size = 1e-9;                      ///< relative difference of two element sizes that are one

}  // namespace

std::vector<Parameter> posterior_parameters(const StudyCase& study) {
  const auto& own = study.parameters();
  if (study.external) return own;  // no handbook knows them
  auto parameters = study.map.product == "physical" ? with_handbook_priors(own) : own;
  if (study.line) return parameters;  // its nuisances are the case's own
  const auto absent = [&](const char* key) { return std::none_of(parameters.begin(), parameters.end(), [&](const Parameter& p) { return p.key == key; }); };
  const auto nuisance = [&](const char* name, const char* key, double median, double sd, double widest) {
    if (sd <= 0 || !absent(key)) return;
    Parameter p{.name = name, .key = key, .prior = "lognormal"};
    p.nominal = median, p.mu = std::log(median), p.sigma = sd;
    p.min = median * std::exp(-widest * sd), p.max = median * std::exp(widest * sd), p.unit = study.forward.about(key).unit;
    parameters.push_back(std::move(p));
  };
  nuisance("regularising_viscosity", viscosity_key, study.emulator.viscosity, study.emulator.viscosity_sd, widest_viscosity);
  nuisance("young", young_key, study.forward.steel.young, study.errors.young_sd, widest_young);
  const double film = study.errors.wall_film, film_sd = study.errors.wall_film_sd;
  if (film_sd > 0 && absent(film_key) && study.on_mesh() && study.forward.geometry.parts() && study.forward.mercury.law != "linear")
    parameters.push_back({.name = "wall_film",
                          .key = film_key,
                          .min = film - widest_film * film_sd,
                          .max = film + widest_film * film_sd,
                          .prior = "normal",
                          .nominal = study.forward.mercury.wall_film,
                          .mean = film,
                          .sd = film_sd,
                          .unit = study.forward.about(film_key).unit});
  return parameters;
}

std::vector<double> element_sizes(const StudyCase& study) {
  if (!study.on_mesh()) return {0};
  if (!study.emulator.element_sizes.empty()) return study.emulator.element_sizes;
  const auto own = study.forward.geometry.resolved().element_size;
  if (!own) return {0};
  return {*own, 0.5 * *own};
}

std::vector<double> diagnosis_element_sizes(const StudyCase& study) {
  const auto own = study.forward.geometry.resolved().element_size;
  const auto& load = study.forward.load;
  const double front = study.forward.mercury.sound_speed * load.pulse_length;
  if (!study.emulator.element_sizes.empty() || !own || load.kind != "initial_pressure" || *own > resolving * front) return element_sizes(study);
  return {2 * *own, *own};
}

EmulatorMeshes emulator_meshes(const StudyCase& study) {
  if (!study.on_mesh()) return EmulatorMeshes::one_size;
  if (!study.forward.geometry.resolved().element_size) return EmulatorMeshes::from_file;
  return element_sizes(study).size() > 1 ? EmulatorMeshes::several : EmulatorMeshes::one_size;
}

std::optional<int> own_level(const StudyCase& study) {
  if (!study.on_mesh()) return std::nullopt;
  const auto own = study.forward.geometry.resolved().element_size;
  if (!own) return std::nullopt;
  const auto sizes = element_sizes(study);
  const auto at = std::find_if(sizes.begin(), sizes.end(), [&](double size) { return std::abs(size / *own - 1) < same_size; });
  return at == sizes.end() ? std::nullopt : std::optional(int(sizes.end() - at) - 1);
}

Eigen::MatrixXd gauge_positions(const StudyCase& study) {
  if (study.line) {
    Eigen::MatrixXd along = Eigen::MatrixXd::Zero(Eigen::Index(study.line->stations.size()), 3);
    for (std::size_t s = 0; s < study.line->stations.size(); ++s) along(Eigen::Index(s), 0) = study.line->stations[s].distance;
    return along;
  }
  if (study.external) return {};  // they have no places
  Eigen::MatrixXd positions(Eigen::Index(study.forward.sensors.size()), 3);
  for (std::size_t s = 0; s < study.forward.sensors.size(); ++s)
    for (std::size_t i = 0; i < 3; ++i) positions(Eigen::Index(s), Eigen::Index(i)) = study.forward.sensors[s].position[i];
  return positions;
}

double mesh_error(const StudyCase& study, double size_from_file) {
  if (!study.on_mesh()) return study.errors.mesh.value_or(0);  // characteristics and spectra carry waves without any
  const auto sizes = element_sizes(study);
  const auto own = study.forward.geometry.resolved().element_size;
  const double size = sizes.size() > 1 && own ? *own : sizes[0] > 0 ? sizes[0] : size_from_file;
  return study.errors.mesh.value_or(std::min(1.0, mesh_error_by_size * size));
}

std::optional<double> elements_per_front(const StudyCase& study) {
  if (!study.on_mesh()) return std::nullopt;
  const auto& load = study.forward.load;
  const double finest = element_sizes(study).back(), front = study.forward.mercury.sound_speed * load.pulse_length;
  if (load.kind != "initial_pressure" || front <= 0 || finest <= 0) return std::nullopt;
  return front / finest;
}

bool basin_on_surrogate(const StudyCase& study) {
  if (!study.on_mesh()) return false;
  if (study.emulator.start != "auto") return study.emulator.start == "surrogate";
  const auto& own = study.forward.parameters;
  const bool known = study.map.product == "physical" || std::all_of(own.begin(), own.end(), [](const Parameter& p) { return p.prior != "uniform"; });
  return !known;
}

/// What a polynomial of order two follows over half a millisecond (boxes of 4.5 % of density, 6 % of sound speed and 0.6e5 to 3.6e5 Pa on the slice `null`:
/// left out, 3.6 % at 1 mm, of which 3.0 % are numerical noise).
double first_half_width(const Parameter& p, bool nuisance) {
  if (nuisance && p.key == film_key) return box_of_film * *p.sd;
  if (nuisance) return (p.key == viscosity_key ? box_of_viscosity : box_of_young) * *p.sigma;
  if (p.key == "material.mercury.density") return 0.035;
  if (p.key == "material.mercury.sound_speed") return 0.05;
  if (p.key == "material.mercury.tensile_cutoff") return p.logarithmic() ? 0.7 : *p.nominal > 0 ? 0.6 * *p.nominal : 0.1 * (p.max - p.min);
  return 0.1 * (p.logarithmic() ? std::log(p.max / p.min) : p.max - p.min);
}

double first_half_width_of_a_line(const Parameter& p) {
  const double middle = *p.nominal,
               reach = box_of_prior * (p.prior == "lognormal" ? *p.sigma * std::exp(*p.mu) : p.sd.value_or((p.max - p.min) / std::sqrt(12.0)));
  return p.coordinate_width(reach, middle);
}

}  // namespace calomel
