#include "apps/presentation/calibration_lines.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/presentation/run_lines.hpp"

namespace calomel {

namespace {

/// "METHOD: SENTENCE" for sentences that are not empty.
std::vector<std::string> of_method(const std::string& method, std::span<const std::string> sentences) {
  std::vector<std::string> lines;
  for (const auto& s : sentences)
    if (!s.empty()) lines.push_back(stage_line(method, s));
  return lines;
}

/// "density -1.2 %, tensile_cutoff +3.0 %": the change from one result to another.
std::string moves_text(const ModelShape& shape, const std::vector<double>& from, const std::vector<double>& to) {
  std::vector<std::string> words;
  for (std::size_t k = 0; k < from.size(); ++k)
    words.push_back(from[k] != 0 ? fmt::format("{} {:+.1f} %", shape.parameters[k].name, 100 * (to[k] / from[k] - 1))
                                 : fmt::format("{} {:+.4g}", shape.parameters[k].name, to[k]));
  return join(words);
}

}  // namespace

std::string meaning_sentence(const std::string& product) {
  if (product == "physical")
    return "physical: handbook priors, and a discrepancy that represents omitted physics; a material property only as far as that discrepancy is a "
           "fair picture of it.";
  return "tuned: the values with which this model imitates these recordings best within the case's bounds; not a material property. They compensate for "
         "whatever the model omits, and the published objective mixes percent with strain.";
}

std::string correction_sentence(const Calibration& calibration, const ModelShape& shape) {
  const CorrectionReport& m = calibration.mesh;
  if (!m.used) return "";
  std::string s = fmt::format("predictions are corrected for the mesh by {} runs of the emulator", m.runs);
  if (!m.calibrated.empty()) s += fmt::format("; at the calibrated point the correction is {:.2g} % of the histories", 100 * m.difference);
  if (!m.without.empty()) s += "; difference from the calibration without it: " + moves_text(shape, m.without, calibration.theta);
  if (!calibration.at_nominal.inside_emulator)
    s += "; the nominal point lies outside the emulator's box, so that its scores are more reliable on the case's own mesh (working_mesh)";
  return s;
}

std::string agreement_sentence(const EncAgreement& agreement, const ModelShape& shape) {
  std::string s;
  std::string apart;
  for (const auto& r : agreement.optimizers)
    if (r.rounds > 0 && !r.agrees)
      apart += fmt::format("{}{} ends {:.2f} of the bounds away, {:.3g} worse", apart.empty() ? "" : "; ", r.name, r.distance, r.shortfall);
  if (agreement.optimizers.size() > 1)
    s = agreement.optimizers_agree
            ? fmt::format("The optimisers agree: the best of each lies within {:g} of the bounds of the best of all.", agreement_tolerance)
            : "The optimisers disagree: " + apart + ".";
  if (agreement.objectives.size() < 2) return s;
  s += s.empty() ? "" : " ";
  if (agreement.objectives_agree) return s + fmt::format("The objectives agree within {:g} of the bounds.", agreement_tolerance);
  apart.clear();
  for (const auto& f : agreement.objectives) {
    if (f.agrees) continue;
    apart += (apart.empty() ? "" : "; ") + f.objective;
    apart += f.theta.empty() ? " has no value anywhere" : " moves " + moves_text(shape, agreement.objectives[0].theta, f.theta);
  }
  return s + "The objectives disagree: " + apart + ". The result depends on the formulation of the misfit.";
}

CalibrationWords calibration_words(const Calibration& calibration, const ModelShape& shape) {
  return {.meaning = meaning_sentence(calibration.product), .mesh = correction_sentence(calibration, shape)};
}

EncWords enc_words(const EncSummary& summary, const ModelShape& shape) {
  return {.calibration = calibration_words(summary, shape), .agreement = agreement_sentence(summary.agreement, shape)};
}

std::string calibration_message(const Calibration& c) {
  if (c.status == CalibrationStatus::not_run) return "the calibration was not run";
  if (c.status == CalibrationStatus::no_candidate)
    return (c.candidates.empty() ? "the surrogate failed at every point" : "the true model failed at every candidate: " + c.candidates[0].message) +
           (c.at_nominal.objective_model ? "; the nominal parameters are kept" : "; the result is the surrogate's alone");
  const std::string value = fmt::format("{} = {:.6g} in the true model at the ", c.objective.name, *c.best.objective_model);
  return c.nominal_kept() ? fmt::format("{}nominal parameters: none of {} candidates is better", value, c.candidates.size())
                          : fmt::format("{}best of {} candidates", value, c.candidates.size());
}

std::vector<std::string> calibration_warnings(const Calibration& c, const ModelShape& shape) {
  std::vector<std::string> out;
  if (c.nominal_kept())
    out.push_back(
        fmt::format("no candidate is better than the nominal parameters in the true model ({:.4g} against {:.4g}): the nominal ones are kept; the surrogate is "
                    "too coarse near its optimum",
                    *c.candidates[0].objective_model, *c.at_nominal.objective_model));
  const bool none = c.status == CalibrationStatus::no_candidate;
  if (none) out.push_back(calibration_message(c));
  if (!c.failed.empty())
    out.push_back(fmt::format("the true model failed at {} candidates, others took their place: {}", c.failed.size(), c.failed[0].message));
  if (!none && c.candidates.size() < c.wanted)
    out.push_back(fmt::format("{} of {} candidates: no more distinct points could be run", c.candidates.size(), c.wanted));
  if (!c.at_nominal.objective_model) out.push_back("the true model failed at the nominal parameters: " + c.at_nominal.message);
  for (std::size_t k = 0; k < shape.parameters.size(); ++k) {
    const Parameter& p = shape.parameters[k];
    const double share = (c.theta[k] - p.min) / (p.max - p.min);
    if (share < 1e-3 || share > 1 - 1e-3)
      out.push_back(fmt::format("{} = {:.6g} lies on its {} bound: its best value is beyond the bound, or the data do not determine it", p.name, c.theta[k],
                                share < 0.5 ? "lower" : "upper"));
  }
  out.insert(out.end(), c.mesh.reservations.begin(), c.mesh.reservations.end());
  if (!c.best.inside_emulator)
    out.push_back(
        "the answer lies outside the box about the posterior in which the emulator knows the mesh error: its correction is that of the box's nearest point. "
        "See where `calomel sample` finds the parameters, and whether they are bounded too widely");
  return out;
}

std::vector<std::string> surrogate_warnings(const SpeSummary& s) {
  std::vector<std::string> out;
  if (!s.too_large.empty()) out.push_back(fmt::format("polynomial spaces of more than {} terms are left out: {}", s.most_terms, join(s.too_large)));
  const auto fails = [](const SparsePolynomial& p) { return !p.ok(); };
  if (const auto n = std::count_if(s.surrogates.begin(), s.surrogates.end(), fails); n > 0)
    out.push_back(
        fmt::format("{} of {} surrogates were left out: {}", n, s.surrogates.size(), std::find_if(s.surrogates.begin(), s.surrogates.end(), fails)->failure));
  if (s.optima.empty()) out.push_back("runs are likely to fail at every optimum of the last surrogates: candidates are the best runs that were made");
  return out;
}

std::vector<std::string> enc_lines(const EncWords& words) { return of_method("enc", std::vector{words.calibration.mesh, words.agreement}); }

std::vector<std::string> spe_lines(const CalibrationWords& words) { return of_method("spe", std::vector{words.mesh}); }

std::vector<std::string> map_lines(const MapSummary& summary, const MapWords& words) {
  return of_method("map", std::vector{summary.status == CalibrationStatus::no_candidate ? "" : words.identified, words.check, words.score_tests, words.nested});
}

std::string not_corrected_line(const std::string& method, EmulatorMeshes meshes) {
  const std::string why = meshes == EmulatorMeshes::from_file ? "the mesh comes from a file, of which the program makes no finer one"
                                                              : "the emulator has one mesh only (emulator.element_sizes)";
  return stage_line(method, "predictions are not corrected for the mesh: " + why);
}

std::string viscosity_left_sentence(const std::string& method, double of_case, double of_emulator) {
  return stage_line(method, fmt::format("the case's mesh has a regularising viscosity of {:.4g} Pa s, the emulator one of {:.4g}, and emulator.viscosity_sd = "
                                        "0: the difference is not taken off",
                                        of_case, of_emulator));
}

}  // namespace calomel
