#pragma once
/// A request for one run of the true model, as plain data with an exact text form. A request can be sent to another process or another machine.
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "forward/parameter.hpp"

namespace calomel {

/// The outputs of a run. A record serves every request whose outputs it contains.
struct Outputs {
  bool mean = true;             ///< the mean over the pulse energies of every history, with its energy gradient and scatter
  bool pulses = false;          ///< the histories of the single pulses
  bool energy_balance = false;  ///< the relative error of the energy balance of one pulse at energy 1
  bool totals = false;          ///< dissipated energy and time at cutoff of one pulse at energy 1
  bool operator==(const Outputs&) const = default;

  /// Whether every output of `other` is among these.
  [[nodiscard]] bool cover(const Outputs& other) const;
  /// The outputs of either.
  [[nodiscard]] Outputs with(const Outputs& other) const;
  [[nodiscard]] bool any() const { return mean || pulses || energy_balance || totals; }
};

/// A random displacement of the mesh's nodes.
struct MeshJitter {
  double share = 0;          ///< of the shortest edge at a node, the largest displacement
  std::uint64_t seed = 1;    ///< of the random stream
  std::uint64_t stream = 0;  ///< index of the random stream; its first number is the energy shift of the same run
  bool operator==(const MeshJitter&) const = default;
};

/// Where and how the true model is run. A member that is left out keeps the value of the case.
struct RunRequest {
  std::map<std::string, double> numbers;  ///< values by the dotted key of the case, e.g. "material.mercury.density": parameters and any further numbers
  std::optional<double> element_size;     ///< of another mesh [m]; 0: the case's own mesh. The mesh then no longer decides the regularising viscosity
  std::optional<int> pulses;              ///< number of pulse energies in the mean
  std::optional<double> energy_shift;     ///< the energies are the quantiles (i + shift) / pulses; 0.5 by default
  double viscosity_factor = 1;            ///< times the viscosity of the numerics, the mesh's own part included
  std::optional<MeshJitter> jitter;
  int refine = 1;         ///< every element of the case's own mesh is divided into so many along each edge
  std::string precision;  ///< "single" or "double"; empty: that of the case
  Outputs wanted;
  bool operator==(const RunRequest&) const = default;
};

/// A request with the parameters' numbers at `theta`, (n_parameters). Errors: ContractFailure when two parameters share a key.
RunRequest request_at(std::span<const Parameter> parameters, std::span<const double> theta);
/// The values of the parameters in a request, (n_parameters). Errors: ContractFailure when the request lacks one.
std::vector<double> theta_at(std::span<const Parameter> parameters, const RunRequest& request);

/// The text of everything but the wanted outputs: "key=value key=value ... mesh=0.001 pulses=1". Values have all their digits, so two requests are the same run
/// exactly when their texts are equal. "case" when nothing differs from the case.
std::string run_text(const RunRequest& request);
/// run_text and the wanted outputs, " want=mean+pulses".
std::string text_of(const RunRequest& request);
/// The request of such a text; without `want=` the mean is wanted. Errors: ContractFailure for any other text.
RunRequest request_of(const std::string& text);

}  // namespace calomel
