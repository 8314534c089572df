#include "apps/pipeline/sample_parts.hpp"

#include <cmath>

#include "apps/interrupt.hpp"
#include "apps/presentation/posterior_lines.hpp"
#include "apps/presentation/run_lines.hpp"
#include "base/artefact.hpp"
#include "base/json.hpp"
#include "inverse/posterior/prior.hpp"

namespace calomel {

namespace {

constexpr const char* journal_name = "posterior.journal";
constexpr double alarming = 2;  ///< prior standard deviations from the handbook beyond which something else is taken to be missing

}  // namespace

std::vector<std::string> absorption(const std::vector<Parameter>& parameters, const Convergence& convergence) {
  std::vector<std::string> out;
  for (const auto& p : parameters)
    for (const auto& s : convergence.parameters) {
      if (s.name != p.name) continue;
      const auto z = prior_deviation(p, p.prior == "lognormal" ? s.q50 : s.mean);
      if (z && std::abs(*z) > alarming) out.push_back(absorption_sentence(p.name, *z));
    }
  return out;
}

std::optional<ExitStatus> finished_sample(StageCall& call, const Provenance& provenance) {
  if (call.finished.due(provenance, {"posterior.json", "posterior.nc"}, Requested::by_user, journal_name)) return std::nullopt;
  call.inputs.notes().say(reused_line("sample"));
  return read_json(call.inputs.artefact("posterior.json")).value("status", "") == "done" ? ExitStatus::done : ExitStatus::not_to_be_trusted;
}

SamplerRun saved_run(StageCall& call, const Provenance& provenance, const CalibrationProgress& progress) {
  const auto& command = call.inputs.command();
  return {.seed = command.seed,
          .threads = command.threads,
          .journal = call.inputs.artefact(journal_name),
          .provenance = provenance,
          .progress = [&](std::size_t done, std::size_t all) { progress("transitions", done, all); },
          .stop = &stop_requested()};
}

void write_sample(StageCall& call, const std::vector<PosteriorGroup>& groups, const Json& json, const Provenance& provenance) {
  write_posterior(call.inputs.artefact("posterior.nc"), groups, provenance);
  write_json(call.inputs.artefact("posterior.json"), json);
  remove_journal(call.inputs.artefact(journal_name));
}

Convergence assessed(const SamplerResult& result, int thin) { return assess(result.quantities, sampling_facts(result, thin)); }

}  // namespace calomel
