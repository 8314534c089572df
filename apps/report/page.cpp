#include "apps/report/page.hpp"

#include <string>

#include "apps/report/parts/traces.hpp"
#include "apps/report/sections/campaign.hpp"
#include "apps/report/sections/candidates.hpp"
#include "apps/report/sections/chains.hpp"
#include "apps/report/sections/convergence.hpp"
#include "apps/report/sections/corner.hpp"
#include "apps/report/sections/diagnosis.hpp"
#include "apps/report/sections/emulator.hpp"
#include "apps/report/sections/floor.hpp"
#include "apps/report/sections/histories.hpp"
#include "apps/report/sections/parameters.hpp"
#include "apps/report/sections/posterior.hpp"
#include "apps/report/sections/provenance.hpp"
#include "apps/report/sections/scores.hpp"
#include "apps/report/sections/sensitivity.hpp"
#include "apps/report/sections/surrogate.hpp"
#include "apps/report/sections/target.hpp"

namespace calomel {

namespace {

Html section(const std::string& id, const std::string& title, const Html& body) {
  return element("section", {{"id", id}, {"aria-labelledby", id + "-title"}}, "\n", element("h2", {{"id", id + "-title"}}, title), "\n", body) + "\n";
}

/// The same, or nothing when the body is empty.
Html section_if_any(const std::string& id, const std::string& title, const Html& body) { return body.empty() ? body : section(id, title, body); }

}  // namespace

Html sections_html(const Study& study, const ReportInput& input) {
  return section_if_any("diagnosis", "Physics that the simulation omits", diagnosis_section(study, input)) +
         section("parameters", "Parameters", parameters_section(study, input)) + section_if_any("emulator", "Emulator and its runs", emulator_section(study)) +
         section("target", "Target and sensors", target_section(input)) +
         section("histories", "Measured and simulated histories", histories_section(study, input)) +
         section("scores", "Accuracy and error by sensor", scores_section(study, input)) +
         section("convergence", "Convergence of the optimisers", convergence_section(study, input)) +
         section("candidates", "Candidates and the \u03c1\u2013c ridge", candidates_section(study, input)) +
         section("posterior", "Posterior", posterior_section(study, input)) + section("sensitivity", "Sensitivity", sensitivity_section(study, input)) +
         section("surrogate", "Surrogate quality", surrogate_section(study, input)) + section("campaign", "Campaign", campaign_section(study, input)) +
         section("floor", "Repeatability floor", floor_section(study, input)) + section("provenance", "Provenance", provenance_section(study, input));
}

Json page_data(const Study& study, const ReportInput& input, const DrawingLimits& limits) {
  return {{"target", target_json(input, limits.quads)},
          {"histories", scored_histories_json(study, input, limits.samples)},
          {"diagnosis", diagnosis_drawings(study)},
          {"diagnosis_histories", diagnosis_histories_json(study, input, limits.samples)},
          {"convergence", convergence_json(study)},
          {"ridge", ridge_json(study, input, limits.points)},
          {"loss", loss_json(study)},
          {"decay", decay_json(study)},
          {"design", design_json(study, input, limits.points)},
          {"corner", corner_json(study, input, limits.points * 3 / 4)},
          {"predictive", predictive_histories_json(study, input, limits.samples)},
          {"priors", priors_json(study, input)},
          {"chains", chains_json(study, input)},
          {"sensitivity", sensitivity_drawings(study, input)}};
}

}  // namespace calomel
