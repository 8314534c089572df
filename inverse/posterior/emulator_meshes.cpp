#include "inverse/posterior/emulator_meshes.hpp"

#include <algorithm>
#include <cmath>

namespace calomel {

namespace {

constexpr double mesh_error_by_size = 80;  ///< over the local amplitude, per metre of element size: the error is of first order
constexpr double resolving = 1.25;         ///< an element of so many lengths of the pulse's front still resolves it
constexpr double same_size = 1e-9;         ///< relative difference of two element sizes that are one

bool has_mesh(const Simulator& simulator) { return simulator.capabilities().meshes != Capabilities::Meshes::none; }

}  // namespace

std::vector<double> element_sizes(const Simulator& simulator, const EmulatorOptions& options) {
  if (!has_mesh(simulator)) return {};
  if (!options.element_sizes.empty()) return options.element_sizes;
  const auto own = simulator.hints().element_size;
  if (!own) return {0};
  return {*own, 0.5 * *own};
}

std::vector<double> diagnosis_element_sizes(const Simulator& simulator, const EmulatorOptions& options) {
  const InferenceHints hints = simulator.hints();
  const auto own = hints.element_size;
  if (!options.element_sizes.empty() || !own || hints.resolved_length <= 0 || *own > resolving * hints.resolved_length)
    return element_sizes(simulator, options);
  return {2 * *own, *own};
}

EmulatorMeshes emulator_meshes(const Simulator& simulator, const EmulatorOptions& options) {
  if (simulator.capabilities().meshes == Capabilities::Meshes::fixed) return EmulatorMeshes::from_file;
  return element_sizes(simulator, options).size() > 1 ? EmulatorMeshes::several : EmulatorMeshes::one_size;
}

std::optional<int> own_level(const Simulator& simulator, const EmulatorOptions& options) {
  const auto own = simulator.hints().element_size;
  if (!own) return std::nullopt;
  const auto sizes = element_sizes(simulator, options);
  const auto at = std::find_if(sizes.begin(), sizes.end(), [&](double size) { return std::abs(size / *own - 1) < same_size; });
  return at == sizes.end() ? std::nullopt : std::optional(int(sizes.end() - at) - 1);
}

double mesh_error(const Simulator& simulator, const EmulatorOptions& options, std::optional<double> given, double size_from_file) {
  if (!has_mesh(simulator)) return given.value_or(0);
  const auto sizes = element_sizes(simulator, options);
  const auto own = simulator.hints().element_size;
  const double size = sizes.size() > 1 && own ? *own : sizes[0] > 0 ? sizes[0] : size_from_file;
  return given.value_or(std::min(1.0, mesh_error_by_size * size));
}

std::optional<double> elements_per_front(const Simulator& simulator, const EmulatorOptions& options) {
  const double front = simulator.hints().resolved_length;
  const auto sizes = element_sizes(simulator, options);
  if (sizes.empty() || front <= 0 || sizes.back() <= 0) return std::nullopt;
  return front / sizes.back();
}

bool basin_on_surrogate(const Simulator& simulator, const EmulatorOptions& options, bool physical) {
  if (simulator.hints().start != InferenceHints::Start::basin) return false;
  if (options.start != "auto") return options.start == "surrogate";
  const auto& own = simulator.shape().parameters;
  const bool known = physical || std::all_of(own.begin(), own.end(), [](const Parameter& p) { return p.prior != "uniform"; });
  return !known;
}

}  // namespace calomel
